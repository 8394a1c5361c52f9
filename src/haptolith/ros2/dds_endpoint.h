#pragma once

#include <dds/dds.h>
#include <ros2_messages.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "haptolith/core/vec.h"
#include "haptolith/ros2/ros2_node.h"

// DDS's own types, for the sources of this folder alone.

namespace haptolith {

using PoseMessage = geometry_msgs_msg_dds__PoseStamped_;
using WrenchMessage = geometry_msgs_msg_dds__WrenchStamped_;
using CloudMessage = sensor_msgs_msg_dds__PointCloud2_;
using TransformsMessage = tf2_msgs_msg_dds__TFMessage_;

inline const dds_topic_descriptor& typeOf(const PoseMessage*) {
  return geometry_msgs_msg_dds__PoseStamped__desc;
}
inline const dds_topic_descriptor& typeOf(const WrenchMessage*) {
  return geometry_msgs_msg_dds__WrenchStamped__desc;
}
inline const dds_topic_descriptor& typeOf(const CloudMessage*) {
  return sensor_msgs_msg_dds__PointCloud2__desc;
}
inline const dds_topic_descriptor& typeOf(const TransformsMessage*) {
  return tf2_msgs_msg_dds__TFMessage__desc;
}

/// Sends messages of one topic.
template <class Message>
class Ros2Writer {
 public:
  Ros2Writer(Ros2Node& node, std::string_view topic, Ros2Qos qos)
      : endpoint_(node.makeWriter(typeOf(static_cast<const Message*>(nullptr)), topic, qos)) {}

  /// Whether DDS has taken it; it may still get lost.
  [[nodiscard]] bool write(const Message& message) const noexcept { return dds_write(endpoint_, &message) >= 0; }

 private:
  dds_entity_t endpoint_;
};

/// Takes messages of one topic, from writers of any reliability.
template <class Message>
class Ros2Reader {
 public:
  Ros2Reader(Ros2Node& node, std::string_view topic)
      : endpoint_(node.makeReader(typeOf(static_cast<const Message*>(nullptr)), topic, Ros2Qos::kStream)) {}

  /// Calls `each(message, writer)` with all received messages, the oldest first; writer: a number that distinguishes
  /// writers.
  template <class Each>
  void take(const Each& each) const {
    constexpr std::size_t kAtOnce = 16;
    std::array<void*, kAtOnce> loans{};
    std::array<dds_sample_info_t, kAtOnce> infos{};
    const dds_return_t count = dds_take(endpoint_, loans.data(), infos.data(), kAtOnce, kAtOnce);
    for (std::size_t i = 0; count > 0 && i < static_cast<std::size_t>(count); ++i) {
      if (infos[i].valid_data) {
        each(*static_cast<const Message*>(loans[i]), infos[i].publication_handle);
      }
    }
    if (count > 0) {
      dds_return_loan(endpoint_, loans.data(), count);
    }
  }

 private:
  dds_entity_t endpoint_;
};

/// A text as DDS's structures hold it, which DDS only reads while it writes.
[[nodiscard]] inline char* textOf(const std::string& text) {
  return const_cast<char*>(text.c_str());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
}

[[nodiscard]] inline std_msgs_msg_dds__Header_ headerOf(std::int64_t wall_ns, const std::string& frame) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  return {{static_cast<std::int32_t>(wall_ns / kSecond_ns), static_cast<std::uint32_t>(wall_ns % kSecond_ns)},
          textOf(frame)};
}

[[nodiscard]] inline geometry_msgs_msg_dds__Quaternion_ messageOf(const Quat& turn) {
  return {turn.x(), turn.y(), turn.z(), turn.w()};
}
[[nodiscard]] inline geometry_msgs_msg_dds__Vector3_ messageOf(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
[[nodiscard]] inline geometry_msgs_msg_dds__Pose_ messageOf(const Pose& pose) {
  const Vec3& at_m = pose.position_m;
  return {{at_m.x(), at_m.y(), at_m.z()}, messageOf(pose.orientation)};
}
[[nodiscard]] inline geometry_msgs_msg_dds__Wrench_ messageOf(const Wrench& wrench) {
  return {messageOf(wrench.force_n), messageOf(wrench.torque_nm)};
}

/// None for numbers that are NaN or infinite, and for a turn of no unit length.
[[nodiscard]] inline std::optional<Pose> poseOf(const geometry_msgs_msg_dds__Pose_& message) {
  const Pose pose{{message.position.x, message.position.y, message.position.z},
                  {message.orientation.w, message.orientation.x, message.orientation.y, message.orientation.z}};
  if (!pose.position_m.allFinite() || !isUnit(pose.orientation)) {
    return std::nullopt;
  }
  return Pose{pose.position_m, pose.orientation.normalized()};
}
/// None for numbers that are NaN or infinite.
[[nodiscard]] inline std::optional<Wrench> wrenchOf(const geometry_msgs_msg_dds__Wrench_& message) {
  const Wrench wrench{{message.force.x, message.force.y, message.force.z},
                      {message.torque.x, message.torque.y, message.torque.z}};
  if (!wrench.force_n.allFinite() || !wrench.torque_nm.allFinite()) {
    return std::nullopt;
  }
  return wrench;
}

}  // namespace haptolith

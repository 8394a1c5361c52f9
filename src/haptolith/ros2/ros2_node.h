#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/ros2/ros2_name.h"

struct dds_topic_descriptor;

namespace haptolith {

/// The ROS 2 graph to join, and the node's name.
struct Ros2Parameters {
  Ros2Name name;
  std::optional<int> domain;  ///< none: ROS_DOMAIN_ID, else 0
  bool localhost = false;     ///< this machine alone; also by ROS_LOCALHOST_ONLY or the discovery range
  /// Whether identifiers have 24 bytes, as up to Humble, or 16; none: as ROS_DISTRO says, else 16.
  std::optional<bool> humble;
};

struct Ros2Ranges {
  static constexpr Range domain{0, 232};  ///< beyond, DDS has no ports
};

/// Reliability, durability and history of a topic, by the conventions of robots.
enum class Ros2Qos : std::uint8_t {
  kStream,   ///< sensor data: best effort, volatile, keep last 5
  kCommand,  ///< reliable, volatile, keep last 1
  kMap,      ///< reliable, volatile, keep last 1: data at a few Hz, displayed by programs that request
             ///< reliable
  kLatched,  ///< reliable, transient local, keep last 1
};

/// A node in a ROS 2 graph without ROS 2: a DDS participant of Cyclone DDS that names topics and types as ROS 2 does,
/// and announces itself on ros_discovery_info. Not for the tick.
class Ros2Node {
 public:
  /// @throws InvalidParameter for names and domains that ROS 2 does not take; Failure when DDS cannot start.
  explicit Ros2Node(const Ros2Parameters& parameters);
  ~Ros2Node();
  Ros2Node(const Ros2Node&) = delete;
  Ros2Node& operator=(const Ros2Node&) = delete;

  /// Endpoints by DDS's handles, which live as long as the node does: see dds_endpoint.h, which knows their types.
  /// @param topic  as Ros2Name::topic().
  [[nodiscard]] std::int32_t makeWriter(const dds_topic_descriptor& type, std::string_view topic, Ros2Qos qos);
  [[nodiscard]] std::int32_t makeReader(const dds_topic_descriptor& type, std::string_view topic, Ros2Qos qos);

  /// Announces all endpoints so far to the graph. To be called when the last has been made.
  void announce();

  [[nodiscard]] const Ros2Name& name() const noexcept { return parameters_.name; }
  [[nodiscard]] int domain() const noexcept { return domain_; }
  /// "/haptolith in domain 0".
  [[nodiscard]] std::string text() const;

 private:
  struct Graph;
  [[nodiscard]] std::int32_t makeTopic(const dds_topic_descriptor& type, const std::string& name);

  Ros2Parameters parameters_;
  int domain_ = 0;
  std::unique_ptr<Graph> graph_;
};

}  // namespace haptolith

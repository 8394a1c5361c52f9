#pragma once

#include <cstdint>
#include <memory>

#include "haptolith/core/error.h"
#include "haptolith/core/process/latest_value.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Target of the tool from a ROS 2 graph.
struct ToolTarget {
  Pose scene_T_tool;
  std::int64_t came_ns = 0;  ///< monotonic clock; 0: none has come yet
};
/// From the thread that reads DDS to the tick.
using TargetInbox = LatestValue<ToolTarget>;

struct TargetParameters {
  double fresh_s =
      0.1;  ///< time without a target after which the tool is released; for nodes that send at 20 Hz and more
  Vec3 low_m, high_m;  ///< scene frame: targets beyond are followed to the edge

  static constexpr Range kFresh_s{0.01, 10};
};

/// The virtual hand, led by targets from a ROS 2 graph: a spring and a damper pull the tool there, no harder than its
/// largest force, so targets may come 10 or 1000 times a second, without velocities, and be far away. Without a fresh
/// one the state is stale: the tool is released, and keeps its place.
///
/// The other end is unknown: it is not simulated(), so force starts and stops as for a person's hand.
class TargetDevice final : public HapticDevice {
 public:
  /// @throws InvalidParameter for fresh_s out of range, and as VirtualHand.
  TargetDevice(std::shared_ptr<TargetInbox> inbox, const TargetParameters& parameters, const HandParameters& hand,
               double tick_s);

  /// Begins like the virtual hand's, whose frame it shares: in recordings the name determines the mapping of poses.
  static constexpr std::string_view kName = "virtual hand led by ROS 2";
  [[nodiscard]] std::string_view name() const noexcept override { return kName; }
  [[nodiscard]] DeviceLimits limits() const noexcept override;
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const DeviceOutput& output) noexcept override { hand_.write(output); }
  void releaseForce() noexcept override { hand_.releaseForce(); }
  void resumeForce() noexcept override { hand_.resumeForce(); }

 private:
  std::shared_ptr<TargetInbox> inbox_;
  TargetParameters parameters_;
  VirtualHand hand_;
  std::int64_t fresh_ns_, taken_ns_ = 0;
  DeviceInput input_;
};

}  // namespace haptolith

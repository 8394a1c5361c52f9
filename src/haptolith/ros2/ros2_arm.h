#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"
#include "haptolith/ros2/ros2_node.h"
#include "haptolith/teleop/robot/robot_arm.h"

namespace haptolith {

/// Topics of a robot in a ROS 2 graph for targets, tool poses and wrenches.
struct Ros2ArmParameters {
  std::string target_topic = "/robot/target_pose";  ///< geometry_msgs/PoseStamped, to it
  std::string pose_topic = "/robot/tool_pose";      ///< geometry_msgs/PoseStamped, from it: any rate
  std::string wrench_topic = "/robot/wrench";       ///< geometry_msgs/WrenchStamped, from it
  Pose base_T_site;                                 ///< the site's origin in the frame of its poses
  bool wrench_of_tool = false;    ///< the wrench is the tool's on the soil, not the soil's on the tool
  double target_period_s = 0.01;  ///< between two targets
  double fresh_s = 0.2;           ///< time without a pose or a wrench after which it is not ready
  double tare_s = 0.5;            ///< duration of the wrenches whose mean is the zero

  static constexpr Range kTargetPeriod_s{1e-3, 0.1};
  static constexpr Range kFresh_s{0.02, 10};
};

/// A robot's arm by ROS 2. Targets are in the frame of the robot's poses, whose frame_id they are given. A wrench whose
/// frame_id is that of the poses has the base's axes, any other those of the tool; both about the tool's origin.
/// Nothing is sent while there is no command.
class Ros2Arm final : public RobotArm {
 public:
  /// @throws InvalidParameter for values out of range and invalid topics; Failure as Ros2Node.
  Ros2Arm(Ros2Node& node, const Ros2ArmParameters& parameters, double tick_s);
  ~Ros2Arm() override;
  Ros2Arm(const Ros2Arm&) = delete;
  Ros2Arm& operator=(const Ros2Arm&) = delete;

  [[nodiscard]] ArmReading move(const HandState& wanted, bool commanded) noexcept override;
  void tare() noexcept override;
  [[nodiscard]] bool ready() const noexcept override;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace haptolith

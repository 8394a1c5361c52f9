#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "haptolith/core/movement.h"
#include "haptolith/device/hand/arm.h"
#include "haptolith/scene/scene.h"
#include "haptolith/teleop/link/command_track.h"
#include "haptolith/teleop/link/robot_report.h"
#include "haptolith/teleop/robot/force_sensor.h"
#include "haptolith/teleop/robot/robot_arm.h"

namespace haptolith {

/// A robot's arm and what keeps it safe. Lengths are in its site frame, z above the soil's first surface.
struct RobotParameters {
  /// Arm that pulls the tool along the command: a compliant arm with 0.73 of critical damping.
  ArmParameters arm{.mass_kg = 1, .damping_n_s_m = 180, .stiffness_n_m = 15000, .lever_m = 0.1};
  double max_force_n = 60;     ///< largest pulling force; the tool then lags behind the command
  double stop_force_n = 100;   ///< it holds when its sensor exceeds this for 20 ms
  double max_speed_m_s = 0.5;  ///< largest speed of the tool; faster commands are followed late
  double jump_m_s = 2;         ///< between two keyframes: no hand is so fast
  double approach_m_s = 0.1;   ///< during automatic movements
  double approach_rad_s = 1;   ///< during automatic movements
  double clear_m = 0.08;       ///< height at which it goes across
  double playout_s = 0.02;     ///< initial buffer of commands against jitter; grows when it runs out
  double longest_gap_s = 0.5;  ///< between two keyframes, to be bridged
  double silence_s = 3;        ///< time without a command after which it retracts; it stops at once
  double hold_s = 1;           ///< duration of a stop for another reason
  Vec3 lowest_m{-0.5, -0.5, -0.3},
      highest_m{0.5, 0.5, 0.5};  ///< its workspace: commands beyond are followed to its edge
  ForceSensorParameters sensor;

  [[nodiscard]] bool operator==(const RobotParameters&) const = default;
};

struct RobotRanges {
  static constexpr Range force_n{0, 1e4, Ends::kOpenBelow};
  static constexpr Range speed_m_s{0, 10, Ends::kOpenBelow};
  static constexpr Range turning_rad_s{0, 100, Ends::kOpenBelow};
  static constexpr Range length_m{-10, 10};
  static constexpr Range time_s{0, 60};
};

/// @throws InvalidParameter with the key, the value and the valid range: also for an arm that a tick cannot follow.
void validate(const RobotParameters& robot, double tick_s);

/// A robot that follows commands by their index: an arm, and its safety functions. The arm is simulated in a
/// separate bed, or external. No common clock with the operator is needed: it executes commands on arrival,
/// in order, at the pace of its ticks, up to a tenth faster when many wait. tick() allocates nothing with a
/// simulated arm.
class Robot {
 public:
  /// @param scene  its bed and tool; it puts the tool at home.
  /// @param surface_m  height of the soil's surface in that scene: the site frame's zero.
  /// @throws InvalidParameter as validate().
  Robot(const RobotParameters& parameters, Scene& scene, double surface_m, const Pose& home);
  /// With another arm, which may be anywhere, and be moved by others while no operator wants it: each approach begins
  /// where the tool is. While the arm is not ready the robot is taring. @throws InvalidParameter as validate().
  Robot(const RobotParameters& parameters, std::unique_ptr<RobotArm> arm, double tick_s);

  /// Takes the keyframes of a packet. @param connection  number that the operator's program has drawn.
  void take(std::uint32_t connection, bool held, std::span<const Keyframe> keyframes);
  /// Asks its sensor for a new zero when it next hangs still in the air: not while it follows.
  void tare() noexcept { wants_tare_ = true; }

  void tick();

  /// Report on the ticks since the last call.
  [[nodiscard]] RobotReport report() noexcept;

  [[nodiscard]] RobotState state() const noexcept { return state_; }
  [[nodiscard]] StopReason reason() const noexcept { return reason_; }
  [[nodiscard]] std::uint32_t connection() const noexcept { return connection_; }
  /// The newest command that has come; 0: none.
  [[nodiscard]] std::uint64_t newest() const noexcept { return track_.empty() ? 0 : track_.newest(); }
  /// The command that it carries out.
  [[nodiscard]] double index() const noexcept { return play_; }
  [[nodiscard]] const Movement& tool() const noexcept { return tool_; }  ///< site frame
  [[nodiscard]] const HandState& wanted() const noexcept { return wanted_; }
  [[nodiscard]] const Wrench& met() const noexcept { return met_; }  ///< last reading of the force sensor, site frame
  [[nodiscard]] bool atForceCap() const noexcept { return at_force_cap_; }
  [[nodiscard]] bool atSpeedCap() const noexcept { return at_speed_cap_; }
  [[nodiscard]] bool atWorkspaceEdge() const noexcept { return at_edge_; }
  /// Number of times that the buffer of commands ran empty.
  [[nodiscard]] std::uint64_t ranOut() const noexcept { return ran_out_; }
  [[nodiscard]] std::uint64_t stops() const noexcept { return stops_; }

 private:
  void play();
  void bridge();
  void decide();
  void stop(StopReason reason) noexcept;
  void become(RobotState state) noexcept;
  void follow(const HandState& command) noexcept;
  void approach(const HandState& command) noexcept;
  void rise() noexcept;
  [[nodiscard]] HandState command() noexcept;
  void want(const Pose& pose, double opening) noexcept;
  void moveTool() noexcept;
  void account() noexcept;

  [[nodiscard]] bool commandsArm() const noexcept;

  RobotParameters parameters_;
  double tick_s_;
  std::unique_ptr<RobotArm> arm_;
  bool begins_at_tool_ = false;  ///< an approach does, since others may have moved the arm
  CommandTrack track_;

  RobotState state_ = RobotState::kTaring;
  StopReason reason_ = StopReason::kNone;
  std::uint32_t connection_ = 0;
  bool held_ = false;
  bool wants_tare_ = false;
  double in_state_s_ = 0, silent_s_ = 0, too_strong_s_ = 0;
  double play_ = 0;     ///< index that is carried out
  double pace_ = 0;     ///< indices in the last tick
  bool plays_ = false;  ///< else it waits for `playout_s` of commands
  double playout_s_;
  bool descends_ = false;  ///< the last part of an approach
  HandState wanted_;
  Movement tool_;
  Wrench met_;
  bool at_force_cap_ = false, at_speed_cap_ = false, at_edge_ = false;
  std::uint64_t ran_out_ = 0, stops_ = 0;

  // Since the last report.
  Wrench sum_;
  std::uint32_t readings_ = 0;
  double reported_index_ = 0;
};

}  // namespace haptolith

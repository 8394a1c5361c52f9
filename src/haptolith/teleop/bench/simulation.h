#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "haptolith/identify/training/strength_map.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/teleop/link/link.h"
#include "haptolith/teleop/link/teleop_packet.h"
#include "haptolith/teleop/operator/force_agreement.h"
#include "haptolith/teleop/operator/learning_model.h"
#include "haptolith/teleop/operator/task_operator.h"
#include "haptolith/teleop/robot/robot.h"

namespace haptolith {

/// Source of the operator's force.
enum class Feedback : std::uint8_t {
  kModel,      ///< a local bed, without delay: model-mediated teleoperation
  kNone,       ///< none: the tool moves freely, and the remote force is read off a display, delayed
  kBilateral,  ///< the robot's sensor, delayed, kept passive by BilateralEnd at both ends
};

/// A teleoperation in simulated time: a virtual hand, a link, a robot in a separate bed.
struct TeleopSetup {
  SceneFile model;  ///< the operator's scene; its hand moves the tool
  SceneFile site;   ///< the robot's; its tool digs there. Its hand and device do not count
  RobotParameters robot;
  LinkParameters up, down;
  Feedback feedback = Feedback::kModel;
  double duration_s = 30;
  Sending sending;
  double bilateral_period_s = 0.002;  ///< period of packets for kBilateral, where delay matters
  double robot_clock_share = 0;       ///< by which the robot's clock is too fast
  /// A hand that does this, in place of the scene's motion; the run ends when it is done.
  std::optional<SiteTask> task;
  std::optional<double> release_s;    ///< time at which the hand releases the tool; not with a task
  std::optional<StrengthMap> learns;  ///< the model does, while it digs: see LearningModel
  bool mends = false;                 ///< the model's surface becomes the one that is seen: see SurfaceMender
};

struct TeleopRanges {
  static constexpr Range duration_s{0.1, 1e5};
  static constexpr Range period_s{1e-3, 1};
  static constexpr Range site_period_s{1e-3, 60};
  static constexpr Range release_s{0, 1e5};
  static constexpr Range clock_share{-0.01, 0.01};
};

/// Result of a task.
struct TaskResult {
  double done_s = 0;  ///< when the operator has seen that it is done; NaN: not in this run
  int strokes = 0;
  double reached = 0;  ///< depth in m, or force in N: see TaskOperator
};

/// Result of a simulation.
struct TeleopResult {
  double duration_s = 0;                     ///< a task may end it sooner
  ForceAgreement agreement;                  ///< displayed and remote force, by command
  double free_m = 0, soil_m = 0;             ///< largest tracking error of the robot's tool: in the air, in soil
  double given_j = 0;                        ///< most energy that the hand had been given, less what it gave
  double behind_s = 0;                       ///< mean age of the command that the newest report was about
  double followed_share = 0;                 ///< fraction of the time since the first command
  double taken_back_j = 0;                   ///< kBilateral: by both ends
  std::uint64_t ran_out = 0, stops = 0;      ///< see Robot
  StopReason last_stop = StopReason::kNone;  ///< that the robot has not got over
  LinkCounts up, down;
  /// kModel, in the dug area, RMS errors: of the operator's map of the surface, a round trip and a second after
  /// the soil has settled; and of the model's surface against the site's, at the end.
  double known_surface_m = 0, apart_surface_m = 0;
  std::optional<TaskResult> task;
  std::optional<ModelSoil> learned;  ///< in the end
  std::uint64_t updates = 0;         ///< updates of the model's soil
  std::uint64_t mended = 0;          ///< particles that were moved
  double update_j = 0;               ///< largest energy given to the hand in excess of that without updates
  /// Largest change of the force within 0.1 s of an update that the hand has not caused, over the detection threshold:
  /// 0.1 N, or 7 % of the force.
  double update_jump = 0;
  double most_update_jumps = 0;  ///< 95 % of them are no larger
};

/// Called now and then with the share that is done; false gives up.
using TeleopProgress = std::function<bool(double share)>;

/// Runs it. Equal setups give equal bits, with one C library. Not for the tick.
/// @throws InvalidParameter, Failure: as all parts of it; Failure when the hand left the scene, or `progress` gave up.
[[nodiscard]] TeleopResult simulateTeleop(const TeleopSetup& setup, const TeleopProgress& progress = {});

}  // namespace haptolith

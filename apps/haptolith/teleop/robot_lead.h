#pragma once

#include <optional>
#include <span>
#include <string>

#include "haptolith/session/session.h"
#include "haptolith/session/session_recording.h"
#include "haptolith/teleop/operator/learning_model.h"
#include "haptolith/teleop/operator/operator_end.h"
#include "haptolith/teleop/operator/surface_mender.h"

namespace haptolith {

/// Properties of a session's soil that are adapted to a robot's site.
struct Likening {
  bool strength = true;  ///< adapted to the robot's forces; requires readyToLearn() of the session's scene
  bool surface = true;   ///< adapted to the robot's view, if canMend() of the scene
};

/// Link to a robot that follows a session's tool. It adapts the session's soil to that of the robot.
class RobotLead {
 public:
  /// @param to      address of the robot, HOST:PORT.
  /// @throws as OperatorEnd.
  RobotLead(const Session& session, const std::string& to, const EndOptions& options, const Likening& likening);

  /// Processes the ticks since the last call, and packets of the robot. To be called often.
  /// @param also  further receiver of the robot's packets.
  void follow(Session& session, std::span<const TickRecord> ticks, SessionRecording& recording,
              const RobotListener& also = {});

  [[nodiscard]] const OperatorEnd& end() const noexcept { return end_; }
  [[nodiscard]] const LearningModel* learning() const noexcept { return learning_ ? &*learning_ : nullptr; }
  /// Returns the number of moved particles of the model.
  [[nodiscard]] std::size_t mended() const noexcept { return mended_; }

 private:
  [[nodiscard]] RobotRow rowOf(const RobotReport& report) const;
  [[nodiscard]] SiteRow rowOf(const SitePacket& seen) const;
  template <class Told>
  void record(const Told& told, SessionRecording& recording) const;
  void learn(Session& session, SessionRecording& recording);
  void begin(const SceneFile& model);
  void mend(Session& session, SessionRecording& recording);

  OperatorEnd end_;
  Likening likening_;
  std::optional<LearningModel> learning_;
  std::optional<SurfaceMender> mender_;
  std::size_t grains_ = 0;     ///< number of particles in the adapted bed
  ToolParameters mended_for_;  ///< tool whose space stays free of moved particles
  std::uint64_t looked_ = 0;   ///< tick of the last check of the surface
  std::size_t mended_ = 0;
  SoilParameters soil_;  ///< soil of the session at the last check
  double tool_friction_ = 0;
  bool in_air_ = true;
  double time_s_ = 0, tick_s_ = 0;
  std::optional<double> first_s_;  ///< time of the first tick sent to the robot
};

}  // namespace haptolith

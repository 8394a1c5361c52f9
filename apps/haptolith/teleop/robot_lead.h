#pragma once

#include <optional>
#include <span>
#include <string>

#include "haptolith/session/session.h"
#include "haptolith/session/session_recording.h"
#include "haptolith/teleop/learning_model.h"
#include "haptolith/teleop/operator_end.h"

namespace haptolith {

/// A robot that follows a session's tool, and the session's soil, which becomes like the one that the robot meets.
class RobotLead {
 public:
  /// @param to      where the robot listens, HOST:PORT.
  /// @param learns  whether the soil does; the session's scene is readyToLearn() then.
  /// @throws as OperatorEnd.
  RobotLead(const Session& session, const std::string& to, const EndOptions& options, bool learns);

  /// What the loop has done since the last call, and what has come from the robot. To be called often.
  /// @param also  who is told that, too.
  void follow(Session& session, std::span<const TickRecord> ticks, SessionRecording& recording,
              const RobotListener& also = {});

  [[nodiscard]] const OperatorEnd& end() const noexcept { return end_; }
  [[nodiscard]] const LearningModel* learning() const noexcept { return learning_ ? &*learning_ : nullptr; }

 private:
  [[nodiscard]] RobotRow rowOf(const RobotReport& report) const;
  [[nodiscard]] SiteRow rowOf(const SitePacket& seen) const;
  template <class Told>
  void record(const Told& told, SessionRecording& recording) const;
  void learn(Session& session, SessionRecording& recording);
  void begin(const Scenario& model);

  OperatorEnd end_;
  bool learns_;
  std::optional<LearningModel> learning_;
  SoilParameters soil_;  ///< that the session had when last looked
  double tool_friction_ = 0;
  bool in_air_ = true;
  double time_s_ = 0, tick_s_ = 0;
  std::optional<double> first_s_;  ///< of the first tick that the robot was told of
};

}  // namespace haptolith

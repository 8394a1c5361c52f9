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

/// What of a session's soil becomes like that of a robot's site.
struct Likening {
  bool strength = true;  ///< by what the robot meets; the session's scene is readyToLearn() then
  bool surface = true;   ///< by what it sees, where the scene canMend()
};

/// A robot that follows a session's tool, and the session's soil, which becomes like the one that the robot meets.
class RobotLead {
 public:
  /// @param to      where the robot listens, HOST:PORT.
  /// @throws as OperatorEnd.
  RobotLead(const Session& session, const std::string& to, const EndOptions& options, const Likening& likening);

  /// What the loop has done since the last call, and what has come from the robot. To be called often.
  /// @param also  who is told that, too.
  void follow(Session& session, std::span<const TickRecord> ticks, SessionRecording& recording,
              const RobotListener& also = {});

  [[nodiscard]] const OperatorEnd& end() const noexcept { return end_; }
  [[nodiscard]] const LearningModel* learning() const noexcept { return learning_ ? &*learning_ : nullptr; }
  /// Grains of the model that were to lie elsewhere.
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
  std::size_t grains_ = 0;     ///< of the bed that is mended
  ToolParameters mended_for_;  ///< in whose way nothing is put
  std::uint64_t looked_ = 0;   ///< at that tick of the loop
  std::size_t mended_ = 0;
  SoilParameters soil_;  ///< that the session had when last looked
  double tool_friction_ = 0;
  bool in_air_ = true;
  double time_s_ = 0, tick_s_ = 0;
  std::optional<double> first_s_;  ///< of the first tick that the robot was told of
};

}  // namespace haptolith

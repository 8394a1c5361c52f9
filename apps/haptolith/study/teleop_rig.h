#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/session/session_recording.h"
#include "haptolith/study/run/session_rig.h"
#include "haptolith/teleop/operator/task_judge.h"
#include "haptolith/teleop/robot/site_robot.h"

#include "teleop/robot_lead.h"

namespace haptolith {

/// A study on a session that runs, whose blocks may be work for a robot: a stand-in on this machine, at the other end
/// of a link with delay. Each trial has a robot of its own, over soil that is level.
class TeleopRig final : public Rig {
 public:
  TeleopRig(Session& session, SessionRecording& recording, SessionRig::Recorder recorder)
      : session_(session), recording_(recording), rig_(session, std::move(recorder)) {}

  /// Everything that the loop has recorded since the last call.
  void follow(const std::vector<TickRecord>& ticks);
  /// The robot that is led; null: none is.
  [[nodiscard]] const RobotLead* lead() const noexcept { return lead_ ? &*lead_ : nullptr; }

  void prepare(const StudyBlock& block, const Stimulus& stimulus) override;
  void show(const StudyBlock& block, const Stimulus& stimulus) override;
  [[nodiscard]] bool ready() override;
  void feel() override;
  TrialSummary rest() override;
  [[nodiscard]] bool workIsDone() override;
  [[nodiscard]] std::string workText() const override;
  [[nodiscard]] TeleopSummary work() const override;
  void pause() override { rig_.pause(); }
  void resume() override { rig_.resume(); }
  void startRecording(const std::filesystem::path& file) override { rig_.startRecording(file); }
  void stopRecording() override { rig_.stopRecording(); }
  [[nodiscard]] double force() const override { return rig_.force(); }
  [[nodiscard]] std::uint32_t buttons() const override { return rig_.buttons(); }
  [[nodiscard]] bool pageMayHold() const override { return rig_.pageMayHold(); }
  [[nodiscard]] std::string deviceName() const override { return rig_.deviceName(); }

 private:
  /// A robot's scene, and its soil at rest.
  struct Site {
    SceneFile scene_file;
    SavedScene level;
  };

  void wantSite(const std::string& name);
  void watchRobot();
  void dismissRobot();

  Session& session_;
  SessionRecording& recording_;
  SessionRig rig_;
  std::optional<TeleopWork> work_;  ///< of the block that is shown
  std::string site_name_;           ///< of what is next
  std::future<Site> coming_;
  std::optional<Site> site_;
  bool wants_robot_ = false;  ///< for the trial that is shown
  std::unique_ptr<RobotBehindLink> robot_;
  // From feel() to rest():
  std::optional<RobotLead> lead_;
  std::optional<TaskJudge> judge_;
  double silent_since_s_ = 0;  ///< time of the run when the robot was last heard
  RobotState state_ = RobotState::kTaring;
  std::optional<double> follows_s_, done_s_;
  int stops_ = 0;
};

}  // namespace haptolith

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

/// Study on a running session with blocks of teleoperation. The robot is simulated on this machine, behind a link with
/// delay. Each trial has a separate robot, over level soil.
class TeleopRig final : public Rig {
 public:
  TeleopRig(Session& session, SessionRecording& recording, SessionRig::Recorder recorder)
      : session_(session), recording_(recording), rig_(session, std::move(recorder)) {}

  /// Processes the ticks that the loop has recorded since the last call.
  void follow(const std::vector<TickRecord>& ticks);
  /// Returns the current robot; null: none.
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
  /// Scene of a robot, and its soil at rest.
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
  std::optional<TeleopWork> work_;  ///< teleoperation of the current block
  std::string site_name_;           ///< name of the next site
  std::future<Site> coming_;
  std::optional<Site> site_;
  bool wants_robot_ = false;  ///< whether the current trial needs a robot
  std::unique_ptr<RobotBehindLink> robot_;
  // Valid from feel() to rest():
  std::optional<RobotLead> lead_;
  std::optional<TaskJudge> judge_;
  double silent_since_s_ = 0;  ///< time of the robot's last report in the run
  RobotState state_ = RobotState::kTaring;
  std::optional<double> follows_s_, done_s_;
  int stops_ = 0;
};

}  // namespace haptolith

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>
#include <string>

#include "run/run_companion.h"
#include "teleop/operator_report.h"
#include "teleop/robot_lead.h"
#include "teleop/teleop_commands.h"
#include "teleop/teleop_end_options.h"

namespace haptolith {

namespace {

constexpr const char* kOperatorExamples = R"(Examples:
  haptolith teleop robot                                simulate a robot, in another terminal
  haptolith teleop operator --connect 127.0.0.1:7410    control it, in scene teleop-model
  haptolith teleop operator regolith --connect 127.0.0.1:7400
                                                        over haptolith teleop link)";

struct OperatorOptions {
  std::string robot;  ///< HOST:PORT
  TeleopEndOptions end;
  bool mends = true;           ///< whether the soil's surface is adapted to the robot's view
  std::optional<bool> learns;  ///< whether the soil is learned from the robot's forces; default: if possible
};

/// Companion for a robot that follows the tool of a run.
class RobotCompanion final : public RunCompanion {
 public:
  RobotCompanion(const OperatorOptions& options, SceneFile& scene_file) : options_(options) {
    if (options.learns.value_or(canLearn(scene_file))) {
      scene_file = readyToLearn(scene_file);
    }
  }

  [[nodiscard]] bool leadsRobot() const override { return true; }

  void begin(const Session& session) override {
    robot_.emplace(
        session, options_.robot, options_.end.end(),
        Likening{.strength = options_.learns.value_or(canLearn(session.shown())), .surface = options_.mends});
  }
  void follow(Session& session, const SessionDriver::News& news, SessionRecording& recording) override {
    robot_->follow(session, news.ticks, recording);
  }
  void showIn(LiveView& view) const override { view.setRobot(robotShown(*robot_)); }
  [[nodiscard]] std::string status() const override { return robotText(*robot_); }
  [[nodiscard]] std::string summary() const override { return robotSummary(*robot_); }
  void addTo(nlohmann::ordered_json& json) const override { json["robot"] = robotJson(*robot_); }

 private:
  OperatorOptions options_;
  std::optional<RobotLead> robot_;  ///< set by begin()
};

}  // namespace

void addTeleopOperator(CLI::App& teleop) {
  auto options = std::make_shared<OperatorOptions>();
  CLI::App* command = teleop.add_subcommand("operator", "Run a scene, and control a robot that follows the tool");
  command->footer(kOperatorExamples);
  command->add_option("--connect", options->robot, "Address of the robot")->option_text("HOST:PORT")->required();
  options->end.addTo(*command);
  CLI::Option* learn = command->add_flag_callback(
      "--learn", [options] { options->learns = true; }, "Adapt the soil to the robot's forces [with contact friction]");
  command
      ->add_flag_callback(
          "--no-learn", [options] { options->learns = false; }, "Do not adapt the soil")
      ->excludes(learn);
  command->add_flag_callback(
      "--no-mend", [options] { options->mends = false; }, "Do not correct the soil's surface by the robot's camera");
  addRunOptions(
      *command,
      [options](SceneFile& scene_file, const SceneOptions&) {
        return std::make_unique<RobotCompanion>(*options, scene_file);
      },
      "teleop-model");
}

}  // namespace haptolith

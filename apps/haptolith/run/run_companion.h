#pragma once

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <memory>
#include <string>

#include "haptolith/scene_file/scene_file.h"
#include "haptolith/session/record_taker.h"
#include "haptolith/session/session.h"
#include "haptolith/session/session_recording.h"
#include "haptolith/viewer/live_view.h"

#include "shared/scene_options.h"
#include "shared/session_driver.h"

namespace CLI {
class App;
}  // namespace CLI

namespace haptolith {

/// Extension of a run by another command: robots that follow the tool, a network that moves it.
class RunCompanion {
 public:
  virtual ~RunCompanion() = default;

  /// Returns the device that holds the tool; null: that of the scene and the command line.
  [[nodiscard]] virtual std::unique_ptr<HapticDevice> device() { return nullptr; }
  /// Returns the receiver of each tick's record, on the thread that takes them; empty: none.
  [[nodiscard]] virtual RecordTaker::Listener listener() { return {}; }
  /// Whether follow() needs each tick's record, and the recording has tables of a robot.
  [[nodiscard]] virtual bool leadsRobot() const { return false; }

  /// Called once, after creation of the bed and before the loop starts. @throws Failure.
  virtual void begin(const Session& session) { static_cast<void>(session); }
  /// Called in each iteration of the main thread.
  virtual void follow(Session& session, const SessionDriver::News& news, SessionRecording& recording) = 0;
  /// Shows the state in the browser view.
  virtual void showIn(LiveView& view) const { static_cast<void>(view); }
  /// Returns a status line instead of the run's; empty: that of the run.
  [[nodiscard]] virtual std::string status() const { return {}; }

  /// Returns the result after the run: lines of text, or a member of the run's JSON object.
  [[nodiscard]] virtual std::string summary() const = 0;
  virtual void addTo(nlohmann::ordered_json& json) const = 0;
};

/// Creates a companion before the bed is created; may change the scene. @throws InvalidParameter, Failure.
using CompanionFactory =
    std::function<std::unique_ptr<RunCompanion>(SceneFile& scene_file, const SceneOptions& options)>;

/// Adds the options of `haptolith run` to a command that runs a scene with a companion.
/// @param scene  default scene; empty: that of `haptolith run`.
void addRunOptions(CLI::App& command, CompanionFactory companion, const std::string& scene = {});

}  // namespace haptolith

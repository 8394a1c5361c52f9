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

/// Part of a run that another command adds: robots that follow the tool, a network that moves it.
class RunCompanion {
 public:
  virtual ~RunCompanion() = default;

  /// Device that holds the tool; none: the one that the scene and the command line name.
  [[nodiscard]] virtual std::unique_ptr<HapticDevice> device() { return nullptr; }
  /// Receives each tick's record on the thread that takes them; empty: none.
  [[nodiscard]] virtual RecordTaker::Listener listener() { return {}; }
  /// Whether follow() needs each tick's record, and the recording has tables of a robot.
  [[nodiscard]] virtual bool leadsRobot() const { return false; }

  /// Once, with the bed made and the loop not yet started. @throws Failure.
  virtual void begin(const Session& session) { static_cast<void>(session); }
  /// After each look of the main thread.
  virtual void follow(Session& session, const SessionDriver::News& news, SessionRecording& recording) = 0;
  /// State in the browser view.
  virtual void showIn(LiveView& view) const { static_cast<void>(view); }
  /// Status line in place of the run's own; empty: the run's own.
  [[nodiscard]] virtual std::string status() const { return {}; }

  /// Result when the run is over: lines of text, or a member of the run's JSON object.
  [[nodiscard]] virtual std::string summary() const = 0;
  virtual void addTo(nlohmann::ordered_json& json) const = 0;
};

/// Makes a companion before the bed is made; may change the scene. @throws InvalidParameter, Failure.
using CompanionFactory =
    std::function<std::unique_ptr<RunCompanion>(SceneFile& scene_file, const SceneOptions& options)>;

/// Adds the options of `haptolith run` to a command that runs a scene with a companion.
/// @param scene  opened when the command line names none; empty: as `haptolith run` does.
void addRunOptions(CLI::App& command, CompanionFactory companion, const std::string& scene = {});

}  // namespace haptolith

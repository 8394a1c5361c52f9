#pragma once

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <memory>
#include <string>

#include "haptolith/scenario/scenario.h"
#include "haptolith/session/record_taker.h"
#include "haptolith/session/session.h"

#include "shared/scene_options.h"
#include "shared/session_driver.h"

namespace CLI {
class App;
}  // namespace CLI

namespace haptolith {

/// Somebody who goes along with a run, and may have its tool: a network of robots, for one.
class RunCompanion {
 public:
  virtual ~RunCompanion() = default;

  /// What holds the tool; none: what the scene and the command line say.
  [[nodiscard]] virtual std::unique_ptr<HapticDevice> device() = 0;
  /// Who is told each tick.
  [[nodiscard]] virtual RecordTaker::Listener listener() = 0;
  /// After each look of the main thread.
  virtual void follow(const Session& session, const SessionDriver::News& news) = 0;

  /// What became of it, when the run is over: lines for people, or a member of the run's JSON object.
  [[nodiscard]] virtual std::string summary() const = 0;
  virtual void addTo(nlohmann::ordered_json& json) const = 0;
};

/// Makes one before the bed is made. @throws InvalidParameter, Failure.
using CompanionFactory =
    std::function<std::unique_ptr<RunCompanion>(const Scenario& scenario, const SceneOptions& options)>;

/// All that `haptolith run` can be told, for a command that runs a scene with a companion.
void addRunOptions(CLI::App& command, CompanionFactory companion);

}  // namespace haptolith

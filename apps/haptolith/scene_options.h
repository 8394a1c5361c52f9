#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "haptolith/bed/bed.h"
#include "haptolith/scenario/scenario.h"

namespace CLI {
class App;
}

namespace haptolith {

class StatusLine;

/// Which scene, as the command line says it; everything else comes from the scenario.
struct SceneOptions {
  std::string scenario_file;
  std::optional<std::string> preset, soil, body, poses_file;
  std::optional<FrictionModel> friction;
  std::optional<Manoeuvre> manoeuvre;
  std::optional<int> threads;
  std::optional<std::uint64_t> seed;
  std::optional<DeviceKind> device;
  std::optional<std::string> device_id, device_library, device_address;

  void addTo(CLI::App& command);
};

/// The scene that the options ask for; not yet checked by validate(), since a command may still change it.
/// @throws InvalidParameter, Failure: as loadScenario(), changePreset(), changeSoil() and changeBody().
[[nodiscard]] Scenario scenarioFor(const SceneOptions& options);

/// Shows in `status` how the bed of a new scene settles; a signal ends it.
[[nodiscard]] SettleProgress settlingIn(StatusLine& status);

}  // namespace haptolith

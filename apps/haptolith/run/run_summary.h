#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>

#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/machine/machine_fit.h"
#include "haptolith/scene/scene.h"
#include "haptolith/scene_file/scene_file.h"

namespace haptolith {

/// Results of a run that the loop does not hold.
struct RunSummary {
  LoopEnd end;
  RealTime real_time;
  std::uint64_t lost_records;
  std::optional<FinestGrain> finest;  ///< what was chosen for this machine
  std::string advice;                 ///< what to do about missed deadlines; empty: nothing
  std::string device_input;           ///< counts of the device's input; empty: none
};

/// The summary as an object of `--json`.
[[nodiscard]] nlohmann::ordered_json summaryJson(const SceneFile& scene_file, const Scene& scene,
                                                 const HapticLoop& loop, const RunSummary& summary);

/// The summary as text for a terminal.
[[nodiscard]] std::string summaryText(const SceneFile& scene_file, const Scene& scene, const HapticLoop& loop,
                                      const RunSummary& summary);

}  // namespace haptolith

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

/// Results of a run that the loop does not contain.
struct RunSummary {
  LoopEnd end;
  RealTime real_time;
  std::uint64_t lost_records;
  std::optional<FinestGrain> finest;  ///< particles chosen for this machine
  std::string advice;                 ///< advice on missed deadlines; empty: none
  std::string device_input;           ///< statistics of the device's input; empty: none
};

/// Returns the summary as an object for `--json`.
[[nodiscard]] nlohmann::ordered_json summaryJson(const SceneFile& scene_file, const Scene& scene,
                                                 const HapticLoop& loop, const RunSummary& summary);

/// Returns the summary as text for a terminal.
[[nodiscard]] std::string summaryText(const SceneFile& scene_file, const Scene& scene, const HapticLoop& loop,
                                      const RunSummary& summary);

}  // namespace haptolith

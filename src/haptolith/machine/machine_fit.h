#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "haptolith/machine/finest_grain.h"
#include "haptolith/scene_file/scene_file.h"

namespace haptolith {

/// The built-in scene whose particles and threads are chosen for the machine where it opens.
inline constexpr std::string_view kAutoScene = "auto";

/// Threads for the loop that leave a core to a browser or whatever else draws the soil: all usable cores but one, 1
/// to 8.
[[nodiscard]] int loopThreads();

/// Options of fitting a scene to the machine.
struct MachineFitOptions {
  std::optional<int> threads;    ///< threads of the loop; empty: 1 or loopThreads(), whichever renders finer particles
  std::filesystem::path folder;  ///< folder that keeps measurements between runs; empty: none
  bool measure_again = false;    ///< ignores measurements kept there
  std::function<void()> measuring;  ///< called before the machine is measured, which takes one to two seconds
};

/// Whether overrides, each "table.key=value", give this key.
[[nodiscard]] bool setsKey(std::span<const std::string> overrides, std::string_view table_and_key);

/// Whether the particles of a scene can be chosen: its bed starts as settled, with particles of one size.
[[nodiscard]] bool canBeFitted(const SceneFile& scene_file);

/// Gives the scene the finest particles that this machine holds in time, and the threads for them: finestGrain(), or
/// what it came to the last time with this processor, these usable cores, instruction set, CPU of the loop and version
/// of the program. Not for the tick.
/// @throws InvalidParameter unless canBeFitted(); Failure when no size fits the bed or `stop` becomes true.
FinestGrain fitToMachine(SceneFile& scene_file, const MachineFitOptions& options, const std::atomic<bool>& stop);

/// The choice as one line: "4.4 mm particles on 1 thread: the finest soil this machine renders in time (1170
/// particles; 4 mm would need 0.71 ms a tick)". @param particles  number in the bed that was made.
[[nodiscard]] std::string text(const FinestGrain& finest, std::size_t particles);

/// A measurement as a file keeps it, and back: none when the text is damaged or of another key.
[[nodiscard]] std::string keptText(const FinestGrain& finest, std::string_view key);
[[nodiscard]] std::optional<FinestGrain> finestIn(std::string_view kept, std::string_view key);

}  // namespace haptolith

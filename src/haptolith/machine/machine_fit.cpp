#include "haptolith/machine/machine_fit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <thread>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/platform/files.h"
#include "haptolith/core/platform/threads.h"
#include "haptolith/core/pluralise.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

/// One more whenever the measurement, or what is kept of it, is another.
constexpr int kMeasurement = 2;

/// A team of more threads than that gains nothing in soil that this machine's neighbours hold
/// (docs/reports/performance.md).
constexpr int kMostThreads = 8;

/// Name of the processor in /proc/cpuinfo.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name") || line.starts_with("CPU part")) {
      return line;
    }
  }
  return "unknown";
}

/// The CPUs that this process runs on.
std::vector<int> usableCores() {
  const CpuSet set = cpusOfThisThread();
  std::vector<int> cores;
  for (std::size_t cpu = 0; cpu < set.size(); ++cpu) {
    if (set[cpu]) {
      cores.push_back(static_cast<int>(cpu));
    }
  }
  return cores;
}

/// All that a measurement depends on.
std::string keyOf(const SceneFile& scene_file, const std::vector<int>& threads) {
  SceneFile measured;  // the measured part of it
  measured.bed = scene_file.bed;
  measured.bed.soil = rescaled(scene_file.bed.soil, kGrainRadii_m.front());
  measured.bed.threads = 1;
  measured.tool = scene_file.tool;
  measured.mesh = scene_file.mesh;
  return fmt::format("measurement {} haptolith {} {} cores {} {} cpu {} threads {} tick {} us\n{}", kMeasurement,
                     HAPTOLITH_VERSION, processor(), fmt::join(usableCores(), ","), simdTarget(), scene_file.loop.cpu,
                     fmt::join(threads, ","), kFinestTick_us, sceneFileText(measured));
}

std::string hashOf(std::string_view bytes) {
  return fmt::format("{:016x}", XXH3_64bits(bytes.data(), bytes.size()));
}

std::string trialLine(const std::optional<GrainTrial>& trial) {
  return trial ? fmt::format("{} {} {} {} {}", trial->radius_m, trial->grains, trial->substeps, trial->threads,
                             std::isinf(trial->tick_us_p99) ? -1 : trial->tick_us_p99)
               : "none";
}

std::optional<GrainTrial> trialIn(const std::string& line) {
  GrainTrial trial;
  std::istringstream in(line);
  if (!(in >> trial.radius_m >> trial.grains >> trial.substeps >> trial.threads >> trial.tick_us_p99)) {
    return std::nullopt;
  }
  if (trial.tick_us_p99 < 0) {
    trial.tick_us_p99 = std::numeric_limits<double>::infinity();
  }
  const bool known = std::ranges::find(kGrainRadii_m, trial.radius_m) != kGrainRadii_m.end();
  const bool sound = known && BedRanges::threads.contains(trial.threads) && trial.substeps >= 0;
  return sound ? std::optional(trial) : std::nullopt;
}

std::optional<FinestGrain> readKept(const fs::path& file, std::string_view key) {
  constexpr std::size_t kLongest = 4096;
  std::ifstream in(file, std::ios::binary);
  std::string bytes(kLongest, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(kLongest));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount())));
  return finestIn(bytes, key);
}

/// Writes it completely or not at all; the scene also opens without it.
void keep(const fs::path& file, const std::string& text) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  const fs::path part = temporaryBeside(file, "part");
  const int descriptor = makeNewFile(part, Readers::kOwner);
  if (descriptor < 0) {
    return;
  }
  const bool whole = writeBytes(descriptor, text);
  const bool closed = closeFile(descriptor);
  if (!whole || !closed || !renameFile(part, file, true)) {
    fs::remove(part, error);
  }
}

}  // namespace

int loopThreads() {
  return std::clamp(static_cast<int>(usableCores().size()) - 1, 1, kMostThreads);
}

bool setsKey(std::span<const std::string> overrides, std::string_view table_and_key) {
  return std::ranges::any_of(overrides, [table_and_key](std::string_view given) {
    return given.starts_with(table_and_key) &&
           given.substr(table_and_key.size()).find_first_not_of(" \t") == given.substr(table_and_key.size()).find('=');
  });
}

bool canBeFitted(const SceneFile& scene_file) {
  return scene_file.bed.start == BedStart::kSettled && grainClasses(scene_file.bed) == 1;
}

std::string keptText(const FinestGrain& finest, std::string_view key) {
  const std::string text =
      fmt::format("haptolith machine {}\n{}\n{}\n", hashOf(key), trialLine(finest.chosen), trialLine(finest.too_slow));
  return text + hashOf(text) + "\n";
}

std::optional<FinestGrain> finestIn(std::string_view kept, std::string_view key) {
  std::istringstream in{std::string(kept)};
  std::string head, chosen_line, slow_line, sum;
  if (!std::getline(in, head) || !std::getline(in, chosen_line) || !std::getline(in, slow_line) ||
      !std::getline(in, sum) || head != "haptolith machine " + hashOf(key) ||
      sum != hashOf(fmt::format("{}\n{}\n{}\n", head, chosen_line, slow_line))) {
    return std::nullopt;
  }
  const std::optional<GrainTrial> chosen = trialIn(chosen_line), too_slow = trialIn(slow_line);
  const bool sound = chosen && (too_slow || slow_line == "none");
  return sound ? std::optional(FinestGrain{.chosen = *chosen, .too_slow = too_slow}) : std::nullopt;
}

FinestGrain fitToMachine(SceneFile& scene_file, const MachineFitOptions& options, const std::atomic<bool>& stop) {
  if (!canBeFitted(scene_file)) {
    throw RefusedAction("auto_resolution",
                        fmt::format("cannot choose the finest particles of '{}': the bed must start as settled, "
                                    "with particles of one size",
                                    scene_file.title));
  }
  std::vector<int> threads{options.threads.value_or(1)};
  if (const int more = loopThreads(); !options.threads && more > 1) {
    threads.push_back(more);
  }
  const std::string key = keyOf(scene_file, threads);
  const fs::path file = options.folder.empty() ? fs::path() : options.folder / ("machine-" + hashOf(key));
  std::optional<FinestGrain> finest = file.empty() || options.measure_again ? std::nullopt : readKept(file, key);
  if (!finest) {
    if (options.measuring) {
      options.measuring();
    }
    LoopParameters loop = scene_file.loop;
    loop.real_time = true;
    finest = finestGrain(scene_file.bed, scene_file.tool, loop, threads, stop);
    if (!file.empty()) {
      keep(file, keptText(*finest, key));
    }
  }
  const std::string before = sceneInWords(scene_file);
  scene_file.bed.soil = rescaled(scene_file.bed.soil, finest->chosen.radius_m);
  if (scene_file.title == before) {  // names the radius
    retitle(scene_file, before);
  }
  scene_file.bed.threads = finest->chosen.threads;
  makeToolMesh(scene_file);
  return *finest;
}

std::string text(const FinestGrain& finest, std::size_t particles) {
  const GrainTrial& chosen = finest.chosen;
  const std::string soil =
      fmt::format("{:g} mm particles on {}", inUnits(chosen.radius_m, 1e-3), pluralise(chosen.threads, "thread"));
  const auto tick = [](const GrainTrial& trial) { return fmt::format("{:.2g} ms per tick", 1e-3 * trial.tick_us_p99); };
  if (!finest.holds()) {
    return fmt::format("{}: the coarsest soil; ticks can be late on this machine ({} particles; {} in a trial)", soil,
                       particles, tick(chosen));
  }
  std::string finer;
  if (finest.too_slow) {
    const double finer_mm = inUnits(finest.too_slow->radius_m, 1e-3);
    finer = std::isinf(finest.too_slow->tick_us_p99)
                ? fmt::format("; {:g} mm exceeds any machine", finer_mm)
                : fmt::format("; {:g} mm would need {}", finer_mm, tick(*finest.too_slow));
  }
  return fmt::format("{}: the finest soil that this machine renders in real time ({} particles{})", soil, particles,
                     finer);
}

}  // namespace haptolith

#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/bed/start/bed_start.h"
#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/figure/figure.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/scene_words.h"

#include "commands.h"
#include "lab/lab_options.h"
#include "shared/common_options.h"
#include "shared/histogram_json.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/stop_on_signal.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

struct BenchOptions {
  LabOptions soil;                  ///< soil and radius of its particles
  std::vector<std::string> scenes;  ///< names or files; replace the other options
  std::vector<int> particles{256, 2000, 10'000, 100'000, 200'000};
  std::vector<FrictionModel> friction{FrictionModel::kIcra2021, FrictionModel::kContact};
  std::vector<int> threads{1, 2};
  HandMotion motion = HandMotion::kStir;
  std::optional<BedStart> start;  ///< empty: settled if it may sleep, else packed
  std::optional<double> sleep_speed_m_s;
  double sleep_distance_mm = 0;
  double duration_s = 1;
  bool json = false;
  std::string figure_file;
  Overwrite overwrite;
};

/// Row of the table.
struct BenchRow {
  std::size_t particles = 0;
  FrictionModel friction = FrictionModel::kIcra2021;
  int threads = 1, substeps = 1;
  Histogram tick_us{0.1}, list_rebuild_us{0.01};
  double made_s = 0;  ///< duration of creating the bed, without settling unless it starts settled
  double awake = 0;   ///< mean number of awake particles over all ticks
  double bytes_per_particle = 0;
  double list_rebuilds_per_tick = 0;

  [[nodiscard]] double particleStepsPerSecond() const { return awake * substeps / (1e-6 * tick_us.mean()); }
};

void letSleep(BedParameters& bed, const BenchOptions& options) {
  bed.sleep = options.sleep_speed_m_s.has_value();
  bed.sleep_speed_m_s = options.sleep_speed_m_s.value_or(0);
  bed.sleep_distance_m = 1e-3 * options.sleep_distance_mm;
}

/// Returns a sandbox of about `particles` on the Moon; 256 with R = 7 mm are the scene icra2021.
BedParameters sandbox(const BenchOptions& options, int particles, FrictionModel friction, int threads) {
  BedParameters bed;
  letSleep(bed, options);
  bed.soil = labSoil(options.soil, 0).soil;
  bed.soil.friction = friction;
  bed.threads = threads;
  const bool icra2021_scene = particles == 256 && options.soil.soil == "P3" && !options.soil.radius_mm;
  if (icra2021_scene) {
    return bed;
  }
  bed = withRoomFor(particles, bed);
  bed.start = options.start.value_or(bed.sleep ? BedStart::kSettled : BedStart::kPacked);
  return bed;
}

/// Settles a bed approximately, so that afterwards mainly the shovel moves it. If it may sleep, it settles until it
/// does.
void settle(Scene& scene) {
  constexpr double kSettling_s = 0.3;
  constexpr double kLongest_s = 5;
  Bed& bed = scene.bed();
  if (bed.parameters().start == BedStart::kSettled) {
    return;
  }
  const double dt = bed.parameters().tick_s / scene.substeps();
  const auto run = [&](double duration_s) {
    double t = 0;
    do {
      throwIfStopped();
      if (const StepStatus status = bed.step(dt); status != StepStatus::kOk) {
        throw Failure(fmt::format("the bed did not settle: {}", text(status)));
      }
      t += dt;
    } while (t < duration_s && bed.awake() > 0);
  };
  bed.setSettling(bed.parameters().soil.friction == FrictionModel::kContact);
  run(kSettling_s);
  bed.setSettling(false);
  run(bed.parameters().sleep ? kLongest_s : kSettling_s);
}

/// Scene of a row.
struct BenchScene {
  std::string what;
  BedParameters bed;
  ToolParameters tool;
  HandParameters hand;
};

BenchRow measure(const BenchOptions& options, const BenchScene& made_of, StatusLine& status) {
  const std::string& what = made_of.what;
  status.update(what + ": the bed is settling");
  const std::int64_t start_ns = monotonicNs();
  Scene scene(made_of.bed, made_of.tool);
  const std::int64_t made_ns = monotonicNs() - start_ns;
  settle(scene);
  HandParameters hand = made_of.hand;
  hand.surface_m = scene.bed().surfaceHeight();
  VirtualHand device(hand, scene.bed().parameters().tick_s);
  HapticLoop loop(scene, device, LoopParameters{}, false);
  BenchRow row;
  row.made_s = 1e-9 * static_cast<double>(made_ns);
  const std::uint64_t rebuilt_before = scene.bed().listRebuilds();
  (void)scene.bed().takeListRebuildUs();  // discards those of settling
  const auto ticks = static_cast<std::uint64_t>(options.duration_s / scene.bed().parameters().tick_s);
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    if (const LoopEnd end = loop.tick(); end != LoopEnd::kRunning) {
      throw Failure(fmt::format("{}: {}", what, text(end)));
    }
    row.list_rebuild_us.add(scene.bed().takeListRebuildUs());
    row.awake += static_cast<double>(scene.bed().awake()) / static_cast<double>(ticks);
    if (tick % 100 == 0) {
      throwIfStopped();
      status.tell([&] {
        return fmt::format("{}: {:.0f} %", what, 100 * static_cast<double>(tick) / static_cast<double>(ticks));
      });
    }
  }
  row.particles = scene.bed().particles();
  row.friction = made_of.bed.soil.friction;
  row.threads = made_of.bed.threads;
  row.substeps = scene.substeps();
  row.tick_us = loop.statistics().tickUs();
  row.bytes_per_particle = static_cast<double>(scene.bytes()) / static_cast<double>(row.particles);
  row.list_rebuilds_per_tick =
      static_cast<double>(scene.bed().listRebuilds() - rebuilt_before) / static_cast<double>(ticks);
  return row;
}

std::vector<BenchScene> scenesOf(const BenchOptions& options) {
  std::vector<BenchScene> scenes;
  for (const std::string& file : options.scenes) {
    for (const int threads : options.threads) {
      const SceneFile scene = findSceneFile(file);
      requireOneTool(scene, "timings");
      scenes.push_back({fmt::format("{}, {}", file, pluralise(threads, "thread")), scene.bed, scene.tool, scene.hand});
      BedParameters& bed = scenes.back().bed;
      bed.threads = threads;
      letSleep(bed, options);
    }
  }
  if (!scenes.empty()) {
    return scenes;
  }
  HandParameters hand;
  hand.motion = options.motion;
  for (const int particles : options.particles) {
    for (const FrictionModel friction : options.friction) {
      for (const int threads : options.threads) {
        const std::string what = fmt::format("{}, {} friction, {}", pluralise(particles, "particle"),
                                             wordFor(kFrictionWords, friction), pluralise(threads, "thread"));
        scenes.push_back({what, sandbox(options, particles, friction, threads), ToolParameters{}, hand});
      }
    }
  }
  return scenes;
}

/// Measures the wake-up latency of a sleeping thread, a lower bound of the lateness of ticks.
Histogram timerLatenessUs() {
  constexpr int kSleeps = 500;
  constexpr std::int64_t kPeriod_ns = 1'000'000;
  Histogram late_us(0.1);
  std::int64_t deadline_ns = monotonicNs();
  for (int i = 0; i < kSleeps; ++i) {
    deadline_ns += kPeriod_ns;
    sleepUntilNs(deadline_ns);
    late_us.add(1e-3 * static_cast<double>(monotonicNs() - deadline_ns));
  }
  return late_us;
}

Json rowJson(const BenchRow& row, HandMotion motion) {
  return {{"particles", row.particles},
          {"awake", std::lround(row.awake)},
          {"friction", wordFor(kFrictionWords, row.friction)},
          {"threads", row.threads},
          {"substeps", row.substeps},
          {"simd", simdTarget()},
          {"hand", wordFor(kHandMotionWords, motion)},
          {"ticks", row.tick_us.count()},
          {"tick_us", histogramJson(row.tick_us)},
          {"particle_steps_per_s", row.particleStepsPerSecond()},
          {"rebuilds_per_tick", row.list_rebuilds_per_tick},
          {"rebuild_us", {{"mean", row.list_rebuild_us.mean()}, {"max", row.list_rebuild_us.max()}}},
          {"memory_bytes_per_particle", row.bytes_per_particle},
          {"made_s", row.made_s}};
}

std::string rowText(const BenchRow& row) {
  return fmt::format(
      "  {:>9} {:>9.0f} {:<8} {:>7} {:>8} {:>9.4g} {:>9.4g} {:>9.4g} {:>9.4g} {:>9.1f} {:>8.0f} {:>7.0f} {:>7.1f}\n",
      row.particles, row.awake, wordFor(kFrictionWords, row.friction), row.threads, row.substeps,
      row.tick_us.percentile(0.5), row.tick_us.percentile(0.99), row.tick_us.percentile(0.999), row.tick_us.max(),
      1e-6 * row.particleStepsPerSecond(), row.list_rebuild_us.max(), row.bytes_per_particle, row.made_s);
}

void drawBench(const OutputFile& file, const std::vector<BenchRow>& rows) {
  Figure figure(file, 900, 600);
  std::string plot = "plot 1000 with lines dashtype 2 linecolor rgb '#888888' title 'one tick of 1 kHz'";
  std::map<std::pair<FrictionModel, int>, std::vector<std::vector<double>>> curves;
  for (const BenchRow& row : rows) {
    curves[{row.friction, row.threads}].push_back(
        {static_cast<double>(row.particles), row.tick_us.percentile(0.5), row.tick_us.percentile(0.99)});
  }
  const char* colours[] = {"#1f6fb4", "#d2691e", "#2e8b57", "#8b3a8b"};
  std::size_t i = 0;
  for (const auto& [what, points] : curves) {
    const std::string name = fmt::format("curve{}", i);
    figure.data(name, points);
    plot += fmt::format(
        ", ${0} using 1:2:2:3 with yerrorlines pointtype 7 linewidth 2 linecolor rgb '{1}' title '{2}, {3}'", name,
        colours[i % 4], wordFor(kFrictionWords, what.first), pluralise(what.second, "thread"));
    ++i;
  }
  figure.command(
      "set logscale xy; set grid; set key top left; set xlabel 'macroparticles'; "
      "set ylabel 'work of a tick / us: median, up to the 99th percentile'");
  figure.command(plot);
  figure.save();
}

void runBench(const BenchOptions& options) {
  const StopOnSignal stop_on_signal;
  StatusLine status;
  requireWritable({options.overwrite(options.figure_file)});
  for (const int particles : options.particles) {
    requireInRange("particles", particles, {1, kMostParticles});
  }
  requireInRange("duration_s", options.duration_s, {0.1, 3600});
  requireInRange("sleep-speed-m-s", options.sleep_speed_m_s.value_or(0), BedRanges::sleep_speed_m_s);
  requireInRange("sleep-distance-mm", options.sleep_distance_mm, {0, 1e3 * BedRanges::sleep_distance_m.highest});
  status.update("wake-up latency test");
  const Histogram late_us = timerLatenessUs();
  std::vector<BenchRow> rows;
  for (const BenchScene& scene : scenesOf(options)) {
    rows.push_back(measure(options, scene, status));
  }
  status.clear();
  if (!options.figure_file.empty()) {
    drawBench(options.overwrite(options.figure_file), rows);
  }
  if (options.json) {
    Json all = Json::array();
    for (const BenchRow& row : rows) {
      all.push_back(rowJson(row, options.motion));
    }
    printJson({{"soil", options.soil.soil}, {"timer_late_us", histogramJson(late_us)}, {"rows", all}});
    return;
  }
  std::string table = fmt::format(
      "bench: {}, {}, {:g} s each. The machine wakes a sleeping thread {:.0f} us late (99 %: {:.0f}).\n\n"
      "  particles     awake friction threads substeps     p50 us    p99 us  p99.9 us    max us  M p.st./s lists us  "
      "B/part.  made s\n",
      options.scenes.empty()
          ? fmt::format("{}, motion {}", options.soil.soil, wordFor(kHandMotionWords, options.motion))
          : fmt::format("{}", fmt::join(options.scenes, ", ")),
      instructionSetName(simdTarget()), options.duration_s, late_us.percentile(0.5), late_us.percentile(0.99));
  for (const BenchRow& row : rows) {
    table += rowText(row);
  }
  table +=
      "\n  us: computing time of one tick. M p.st./s: million awake particles times substeps per second.\n  lists us: "
      "maximum time of the neighbour lists in one tick.\n";
  printText(table);
}

}  // namespace

void addBenchCommand(CLI::App& app) {
  auto options = std::make_shared<BenchOptions>();
  options->soil.soil = "P3";
  CLI::App* command = app.add_subcommand("bench", kBenchDescription);
  command
      ->add_option("--scene", options->scenes,
                   "Scenes to measure, by name or file; of the other options only --threads applies")
      ->delimiter(',');
  command->add_option("--particles", options->particles, "Approximate numbers of particles")
      ->delimiter(',')
      ->capture_default_str();
  std::map<std::string, FrictionModel> models;
  for (const auto& word : kFrictionWords) {
    models.emplace(word.name, word.value);
  }
  command->add_option("--friction-model", options->friction, "Friction models [icra2021,contact]")
      ->delimiter(',')
      ->transform(wordOf(models));
  command->add_option("--threads", options->threads, "Numbers of threads")
      ->delimiter(',')
      ->check(wholeNumberIn(BedRanges::threads))
      ->capture_default_str();
  command->add_option("--soil", options->soil.soil, fmt::format("{} [P3]", kSoilHelp));
  command->add_option("--radius-mm", options->soil.radius_mm, "Radius of a particle in mm [the soil's]");
  const std::map<std::string, BedStart> starts{{"packed", BedStart::kPacked}, {"settled", BedStart::kSettled}};
  command->add_option("--start", options->start, "Initial state of the soil [packed; settled if it may sleep]")
      ->transform(wordOf(starts));
  const std::map<std::string, HandMotion> motions{{"stir", HandMotion::kStir}, {"still", HandMotion::kStill}};
  command->add_option("--motion", options->motion, "Motion of the hand [stir]")->transform(wordOf(motions));
  command->add_option("--sleep-speed-m-s", options->sleep_speed_m_s,
                      "Particles slower than this can sleep, in m/s [none sleep]");
  command->add_option("--sleep-distance-mm", options->sleep_distance_mm,
                      "Largest travel of a sleeping particle, in mm [20 ms at that speed]");
  command->add_option("--duration-s", options->duration_s, "Simulated time of each row [1]")->option_text("SECONDS");
  command->add_option("--figure", options->figure_file,
                      "Draw the time of a tick over particles to this file (.svg or .png)");
  options->overwrite.addTo(*command);
  addJson(*command, options->json);
  command->footer(
      "Examples:\n  haptolith bench --particles 256,2000 --threads 1\n  haptolith bench --figure bench.svg\n  "
      "haptolith bench --particles 1000000 --friction-model contact --threads 2 \\\n    "
      "--sleep-speed-m-s 0.001");
  command->callback([options] { runBench(*options); });
}

}  // namespace haptolith

#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/bed/start/tile_cache.h"
#include "haptolith/core/error.h"
#include "haptolith/core/platform/descriptor.h"
#include "haptolith/machine/check.h"
#include "haptolith/machine/machine_fit.h"
#include "haptolith/machine/machine_summary.h"
#include "haptolith/machine/real_time_checks.h"
#include "haptolith/scene_file/scene_file.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/histogram_json.h"
#include "shared/output.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kDoctorExamples = R"(Examples:
  haptolith doctor                      takes about 12 seconds
  haptolith doctor --duration-s 600     find rare late wake-ups
  haptolith doctor --cpu 3              measure the CPU that `haptolith run --cpu 3` uses

Exit status: 0 the loop can run in real time, 1 a requirement is not met.)";

struct DoctorOptions {
  double duration_s = 10;
  int cpu = kAnyCpu;
  bool json = false;
};

const char* text(Fitness verdict) {
  switch (verdict) {
    case Fitness::kOk: return "ok";
    case Fitness::kImprovable: return "could be better";
    case Fitness::kInsufficient: return "lacking";
  }
  return "";
}

/// Adds colour codes of a terminal, or nothing.
class Paint {
 public:
  explicit Paint(bool coloured) : coloured_(coloured) {}

  [[nodiscard]] std::string in(const char* code, std::string_view what) const {
    return coloured_ ? fmt::format("\033[{}m{}\033[0m", code, what) : std::string(what);
  }
  [[nodiscard]] std::string bold(std::string_view what) const { return in("1", what); }
  [[nodiscard]] std::string dim(std::string_view what) const { return in("2", what); }
  [[nodiscard]] std::string command(std::string_view what) const { return in("36", what); }
  [[nodiscard]] std::string verdict(Fitness verdict, std::string_view what) const {
    return in(verdict == Fitness::kOk ? "32" : verdict == Fitness::kImprovable ? "33" : "1;31", what);
  }

 private:
  bool coloured_;
};

std::ptrdiff_t count(const std::vector<Check>& checks, Fitness verdict) {
  return std::count_if(checks.begin(), checks.end(), [&](const Check& check) { return check.verdict == verdict; });
}

std::string namesOf(const std::vector<Check>& checks, Fitness verdict) {
  std::string names;
  for (const Check& check : checks) {
    if (check.verdict == verdict) {
      names += (names.empty() ? "" : ", ") + check.name;
    }
  }
  return names;
}

Fitness worst(const std::vector<Check>& checks) {
  Fitness verdict = Fitness::kOk;
  for (const Check& check : checks) {
    verdict = std::max(verdict, check.verdict);
  }
  return verdict;
}

std::string checkText(const Check& check, const Paint& paint) {
  std::string lines =
      fmt::format("  {}  {}{}\n", paint.verdict(check.verdict, fmt::format("{:<15}", text(check.verdict))),
                  paint.bold(fmt::format("{:<17}", check.name)), check.found);
  if (check.verdict != Fitness::kOk) {
    lines += fmt::format("{:36}{}\n", "", paint.dim("needed: " + check.needed));
    if (!check.remedy.empty()) {
      lines += fmt::format("{:36}{}\n", "", paint.command(check.remedy));
    }
  }
  return lines;
}

/// Returns the measured numbers over those required by the loop.
std::string wakeUpText(const WakeUps& measured, const Paint& paint) {
  const Histogram& late_us = measured.late_us;
  if (late_us.count() == 0) {
    return "";
  }
  const double in_time = 1 - static_cast<double>(measured.missed) / static_cast<double>(late_us.count());
  constexpr const char* kRow = "  {:<16} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9}\n";
  const auto us = [](double value) { return fmt::format("{:.1f}", value); };
  return fmt::format("\n  Wake-up latency in us of a thread that sleeps until the next ms, for {:.1f} s ({}, {}):\n\n",
                     measured.seconds, measured.real_time.scheduler,
                     measured.real_time.cpu == kAnyCpu ? "any CPU" : fmt::format("CPU {}", measured.real_time.cpu)) +
         paint.dim(fmt::format(kRow, "", "mean", "p50", "p99", "p99.9", "max", "missed", "in time")) +
         fmt::format(kRow, "measured", us(late_us.mean()), us(late_us.percentile(0.5)), us(late_us.percentile(0.99)),
                     us(late_us.percentile(0.999)), us(late_us.max()), measured.missed,
                     fmt::format("{:.3f} %", 100 * in_time)) +
         fmt::format(kRow, "the loop needs", "", "", "", fmt::format("< {:g}", kLatestWakeUp_us), "< 1000", "0",
                     "100 %") +
         paint.dim(
             fmt::format("\n  Each tick of 1000 us has {:g} us for the wake-up and {:g} us for the computation.\n",
                         kLatestWakeUp_us, 1000 - kLatestWakeUp_us));
}

/// Returns the abilities of this machine in five lines.
std::string summaryText(const std::vector<SummaryLine>& summary, const Paint& paint) {
  std::string lines = paint.bold("Summary of this machine") + "\n\n";
  for (const SummaryLine& line : summary) {
    lines += fmt::format("  {}  {}\n", paint.bold(fmt::format("{:<13}", line.name)), line.text);
  }
  return lines;
}

std::string reportText(const std::vector<Check>& checks, const WakeUps& measured, const std::optional<FinestSoil>& soil,
                       const Paint& paint) {
  std::string report = paint.bold("Can this machine run the loop in real time?") + "\n\n";
  for (const Check& check : checks) {
    report += checkText(check, paint);
  }
  report += wakeUpText(measured, paint);
  const std::ptrdiff_t could_be_better = count(checks, Fitness::kImprovable);
  const Fitness verdict = worst(checks);
  const std::string told = verdict == Fitness::kInsufficient ? fmt::format("No. Lacking: {}.", namesOf(checks, verdict))
                           : could_be_better > 0             ? fmt::format("Yes; {} could be better.", could_be_better)
                                                             : "Yes.";
  return report + "\n" + paint.verdict(verdict, told) + "\n\n" +
         summaryText(machineSummary(checks, measured, soil), paint);
}

Json soilJson(const std::optional<FinestSoil>& soil) {
  return soil ? Json{{"radius_mm", 1e3 * soil->radius_m},
                     {"particles", soil->particles},
                     {"threads", soil->threads},
                     {"predicted_tick_us_p99", soil->tick_us_p99},
                     {"in_time", soil->in_time}}
              : Json(nullptr);
}

Json reportJson(const std::vector<Check>& checks, const WakeUps& measured, const std::optional<FinestSoil>& soil) {
  Json list = Json::array();
  for (const Check& check : checks) {
    list.push_back({{"name", check.name},
                    {"verdict", text(check.verdict)},
                    {"found", check.found},
                    {"needed", check.needed},
                    {"remedy", check.remedy}});
  }
  const RealTime& granted = measured.real_time;
  return {{"verdict", text(worst(checks))},
          {"checks", list},
          {"seconds", measured.seconds},
          {"scheduler", granted.scheduler},
          {"memory_locked", granted.memory_locked},
          {"cpu", granted.cpu == kAnyCpu ? Json(nullptr) : Json(granted.cpu)},
          {"wake_ups", measured.late_us.count()},
          {"missed", measured.missed},
          {"late_us", histogramJsonWithBuckets(measured.late_us)},
          {"finest_soil", soilJson(soil)}};
}

WakeUps measure(const DoctorOptions& options) {
  StatusLine status;
  return measureWakeUps({.cpu = options.cpu}, options.duration_s, stopAsked(), [&](double elapsed_s, double latest_us) {
    if (status.visible()) {
      status.update(fmt::format("wake-up latency test: {:.1f} of {:g} s, latest wake-up {:.0f} us (Ctrl-C ends it)",
                                elapsed_s, options.duration_s, latest_us));
    }
  });
}

/// Returns the finest soil of the default scene that this machine computes in time; empty after Ctrl-C.
std::optional<FinestSoil> finestSoil(const DoctorOptions& options) {
  if (stopAsked()) {
    return std::nullopt;
  }
  StatusLine status;
  status.update("searching the finest soil for this machine");
  SceneFile scene = findSceneFile(std::string(kAutoScene));
  scene.loop.cpu = options.cpu;
  try {
    const FinestGrain found = fitToMachine(
        scene, {.threads = {}, .folder = tileFolder(), .measure_again = true, .measuring = {}}, stopAsked());
    return FinestSoil{.radius_m = found.chosen.radius_m,
                      .particles = found.chosen.grains,
                      .threads = found.chosen.threads,
                      .tick_us_p99 = found.chosen.tick_us_p99,
                      .in_time = found.holds()};
  } catch (const Failure&) {
    if (!stopAsked()) {
      throw;
    }
    return std::nullopt;
  }
}

void doctor(const DoctorOptions& options) {
  const StopOnSignal stop_on_signal;
  requireInRange("duration_s", options.duration_s, {0.1, 1e6});
  const WakeUps measured = measure(options);
  const std::vector<Check> checks = realTimeChecks(measured);
  const std::optional<FinestSoil> soil = finestSoil(options);
  if (options.json) {
    printJson(reportJson(checks, measured, soil));
  } else {
    printText(reportText(checks, measured, soil, Paint(isColoured(kStandardOutput))));
  }
  if (worst(checks) == Fitness::kInsufficient) {
    throw Failure(fmt::format("the loop cannot run in real time here: {}", namesOf(checks, Fitness::kInsufficient)));
  }
}

}  // namespace

void addDoctorCommand(CLI::App& app) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand("doctor", "Check whether this machine can run the loop in real time");
  command->footer(kDoctorExamples);
  command->add_option("--duration-s", options->duration_s, "Duration of the wake-up latency test [10]")
      ->option_text("SECONDS");
  command->add_option("--cpu", options->cpu, "CPU to measure on [any]")->option_text("N");
  addJson(*command, options->json);
  command->callback([options] { doctor(*options); });
}

}  // namespace haptolith

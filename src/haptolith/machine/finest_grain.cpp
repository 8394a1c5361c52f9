#include "haptolith/machine/finest_grain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <vector>

#include "haptolith/bed/critical_step.h"
#include "haptolith/core/error.h"
#include "haptolith/core/histogram.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/core/platform/start_thread.h"
#include "haptolith/haptics/loop/loop_clock.h"
#include "haptolith/haptics/real_time.h"
#include "haptolith/tool/tool_contact.h"

namespace haptolith {

namespace {

/// Number of particles in settled soil over that of a close packing, which needs no settling: 0.81 for lunar-0-15cm
/// of 3.5 and 2.5 mm, 35 mm deep. Each costs as much.
constexpr double kSettledShare = 0.81;

/// Particles times steps that no thread of any machine does in a microsecond, tenfold what one of 2023 does: what would
/// need more is not made.
constexpr double kNoThread_per_us = 500;

/// The stirring of a trial: as far and as fast as the virtual hand, at once.
constexpr double kReach_m = 0.02;
constexpr double kStir_m_s = 0.15;
constexpr double kEnter_m_s = 0.3;
constexpr double kDepth_m = 0.02;
constexpr std::uint64_t kTicks = 250;

BedParameters packingOf(BedParameters bed, double radius_m) {
  bed.soil = rescaled(bed.soil, radius_m);
  bed.start = BedStart::kPacked;
  bed.sleep = false;
  return bed;
}

/// Whether a tick would take a machine that does not exist.
bool isBeyondAnyMachine(const BedParameters& bed, int substeps) {
  const double mass_kg = bed.soil.rho0_kg_m3 * bed.width_m * bed.length_m * bed.depth_m;
  const double grains = mass_kg / macroparticleMass(bed.soil);
  return grains * substeps > kNoThread_per_us * bed.threads * kFinestTick_us;
}

/// Pose of the tool at a time: down at first, then in circles.
HandState stirring(const Scene& scene, double surface_m, double time_s) {
  const BedParameters& bed = scene.bed().parameters();
  const double reach_m = std::min({kReach_m, bed.width_m / 4, bed.length_m / 4});
  const double down_m = std::min(kDepth_m, bed.depth_m / 2);
  const double into_s = down_m / kEnter_m_s;
  const double angle = std::max(0.0, time_s - into_s) * kStir_m_s / reach_m;
  HandState hand;
  hand.pose.position_m = Vec3(reach_m * portable::cos(angle), reach_m * portable::sin(angle),
                              surface_m - down_m * std::min(1.0, time_s / into_s));
  return hand;
}

/// The 99th percentile of ticks in step with the clock, as the loop's: one that has slept finds its data cold, and the
/// other threads asleep. Disturbances only add to a tick, so the first of ten turns that stays within the time
/// counts; another is over as soon as too many of its ticks are.
double slowTickUs(Scene& scene, const LoopParameters& loop, const std::atomic<bool>& stop) {
  constexpr int kTurns = 10;
  constexpr std::uint64_t kAllowed = kTicks / 100;
  const double surface_m = scene.bed().surfaceHeight();
  const auto period_ns = static_cast<std::int64_t>(std::llround(1e9 * loop.tick_s));
  std::int64_t wanted_ns = monotonicNs();
  int ticks = 0;
  const auto tick_us = [&] {
    wanted_ns = std::max(wanted_ns + period_ns, monotonicNs());
    if (loop.real_time) {
      sleepUntilTick(wanted_ns, scene.bed());
    }
    const std::int64_t start_ns = monotonicNs();
    if (const StepStatus status = scene.tick(stirring(scene, surface_m, ++ticks * loop.tick_s));
        status != StepStatus::kOk) {
      throw Failure(fmt::format("cannot measure this machine: {}", text(status)));
    }
    return kSettledShare * 1e-3 * static_cast<double>(monotonicNs() - start_ns);
  };
  scene.bed().scheduleHelpers(helpersSchedule());
  scene.placeTool(stirring(scene, surface_m, 0));
  while (ticks * loop.tick_s < kDepth_m / kEnter_m_s && !stop) {
    (void)tick_us();
  }
  double p99_us = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < kTurns && !stop; ++turn) {
    Histogram turn_us(0.1);
    std::uint64_t over = 0;
    while (turn_us.count() < kTicks && over <= kAllowed && !stop) {
      const double took_us = tick_us();
      turn_us.add(took_us);
      over += took_us > kFinestTick_us ? 1 : 0;
    }
    p99_us = std::min(p99_us, turn_us.percentile(0.99));
    if (over <= kAllowed) {
      break;
    }
  }
  return p99_us;
}

}  // namespace

FinestGrain finestOf(std::span<const double> radii_m, const std::function<GrainTrial(double radius_m)>& trial) {
  std::optional<GrainTrial> holds, too_slow;
  std::size_t first = 0, end = radii_m.size();  // range of candidates for the finest
  while (first < end) {
    const std::size_t middle = first + (end - first) / 2;
    const GrainTrial tried = trial(radii_m[middle]);
    if (tried.tick_us_p99 <= kFinestTick_us) {
      holds = tried;
      first = middle + 1;
    } else {
      too_slow = tried;
      end = middle;
    }
  }
  if (!holds && !too_slow) {
    throw InvalidParameter("radii_m", "none", "one at least");
  }
  return {.chosen = holds ? *holds : *too_slow, .too_slow = too_slow};
}

FinestGrain finestGrain(const BedParameters& bed, const ToolParameters& tool, const LoopParameters& loop,
                        std::span<const int> threads, const std::atomic<bool>& stop) {
  const auto substeps_of = [&](const BedParameters& packing) {
    return substepsFor(packing, stiffnessInStep(tool, packing.soil.friction));
  };
  const auto trial = [&](double radius_m, int on_threads) {
    BedParameters packing = packingOf(bed, radius_m);
    packing.threads = on_threads;
    const int substeps = substeps_of(packing);
    GrainTrial found{.radius_m = radius_m,
                     .substeps = substeps,
                     .threads = on_threads,
                     .tick_us_p99 = std::numeric_limits<double>::infinity()};
    if (isBeyondAnyMachine(packing, substeps)) {
      return found;
    }
    Scene scene(packing, tool);
    found.grains = static_cast<std::size_t>(std::lround(kSettledShare * static_cast<double>(scene.bed().particles())));
    if (!loop.real_time) {
      found.tick_us_p99 = slowTickUs(scene, loop, stop);
    } else {
      std::exception_ptr problem;
      startThread("a measurement", [&] {
        try {
          (void)requestRealTime(loop, false);  // a host of the library need not lock its memory
          found.tick_us_p99 = slowTickUs(scene, loop, stop);
        } catch (...) {
          problem = std::current_exception();
        }
      }).join();
      if (problem) {
        std::rethrow_exception(problem);
      }
    }
    if (stop.load()) {
      throw Failure("interrupted while the machine was measured");
    }
    return found;
  };
  std::vector<double> possible;
  std::string why;
  for (const double radius_m : kGrainRadii_m) {
    try {
      const BedParameters packing = packingOf(bed, radius_m);
      validate(packing);
      (void)substeps_of(packing);
      possible.push_back(radius_m);
    } catch (const InvalidParameter& error) {
      why = error.what();
    }
  }
  if (possible.empty()) {
    throw Failure(fmt::format("no particles of R = {:g} to {:g} mm fit this bed: {}", 1e3 * kGrainRadii_m.back(),
                              1e3 * kGrainRadii_m.front(), why));
  }
  const int most_threads = threads.back();
  FinestGrain found = finestOf(possible, [&](double radius_m) { return trial(radius_m, most_threads); });
  // Disturbances only add to a trial: the next finer radius has another one, and when it holds, the one after it.
  auto next = std::ranges::find(possible, found.chosen.radius_m) + (found.holds() ? 1 : 0);
  for (; next != possible.end(); ++next) {
    const GrainTrial again = trial(*next, most_threads);
    if (again.tick_us_p99 > kFinestTick_us) {
      found.too_slow = again;
      break;
    }
    found.chosen = again;
    found.too_slow.reset();
  }
  for (const int fewer : threads) {
    if (fewer == most_threads || !found.holds()) {
      break;
    }
    if (const GrainTrial tried = trial(found.chosen.radius_m, fewer); tried.tick_us_p99 <= kFinestTick_us) {
      found.chosen = tried;
      break;
    }
  }
  return found;
}

}  // namespace haptolith

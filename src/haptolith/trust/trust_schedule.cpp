#include "haptolith/trust/trust_schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/process/in_parallel.h"
#include "haptolith/scene_file/soil_file.h"

namespace haptolith {

namespace {

constexpr const char* kNoTime = "no time for it";
constexpr double kStrength_s = 150;  ///< duration of a shear test on one thread

double budgetOf(const TrustExtent& extent) {
  return 60 * extent.minutes * extent.threads;
}

/// Time for soil to settle that is in the cache now, but will not be when it is changed: 2 s at a usual speed.
double usualSettling(const SceneFile& scene, const TrustForce& force) {
  constexpr double kTicks = 2000;
  constexpr double kParticleSteps_per_s = 1e7;
  return scene.bed.start == BedStart::kSettled
             ? static_cast<double>(force.particles) * force.substeps * kTicks / kParticleSteps_per_s
             : 0;
}

/// Fills a schedule.
class Scheduler {
 public:
  Scheduler(const SceneFile& scene, const TrustExtent& extent, const std::vector<TrustForce>& first)
      : scene_(scene), extent_(extent) {
    constexpr double kLeast_s = 0.2;
    alone_s_ = kLeast_s;
    for (const TrustForce& force : first) {
      alone_s_ = std::max(alone_s_, std::max(force.settling_s, usualSettling(scene, force)) + force.movement_s);
    }
    usual_surface_m_ = first.front().surface_m;
  }

  TrustSchedule schedule() {
    (void)fits(TrustChange::kNone, extent_.specimens, 1);
    add(TrustChange::kNone, extent_.specimens);
    for (const TrustChange change : {TrustChange::kWideX, TrustChange::kWideY, TrustChange::kDeep}) {
      addIfItFits(change, {1});
    }
    addIfItFits(TrustChange::kRadius, {0.5, 0.71, 1.5});
    for (const TrustChange change :
         {TrustChange::kStep, TrustChange::kStiff, TrustChange::kAwake, TrustChange::kMesh}) {
      addIfItFits(change, {1});
    }
    return std::move(schedule_);
  }

 private:
  bool fits(TrustChange change, int specimens, double radius_ratio) {
    const double cost_s = alone_s_ * relativeCost(change, radius_ratio) * specimens;
    if (planned_s_ + cost_s > budgetOf(extent_)) {
      return false;
    }
    planned_s_ += cost_s;
    return true;
  }

  /// With the first ratio that fits, with few specimens rather than the next ratio.
  void addIfItFits(TrustChange change, const std::vector<double>& ratios) {
    constexpr int kSome = 3;
    if (!extent_.wants(nameOf(change))) {
      return;
    }
    for (const double ratio : ratios) {
      for (const int specimens : {extent_.specimens, std::min(extent_.specimens, kSome)}) {
        if (fits(change, specimens, ratio)) {
          add(change, specimens, ratio);
          return;
        }
      }
    }
    schedule_.rows.push_back({.change = change, .radius_ratio = ratios.front(), .specimens = {}, .why_not = kNoTime});
  }

  /// Adds a row with its runs, or with the reason why there are none.
  void add(TrustChange change, int specimens, double radius_ratio = 1) {
    TrustForces row{.change = change, .radius_ratio = radius_ratio, .specimens = {}, .why_not = {}};
    row.specimens.resize(static_cast<std::size_t>(specimens));
    for (int i = 0; i < specimens; ++i) {
      PlannedRun plan = planned(scene_, change, static_cast<std::size_t>(i), radius_ratio);
      if (!plan.run) {
        row.why_not = plan.why_not;
        row.specimens.clear();
        break;
      }
      plan.run->usual_surface_m = change == TrustChange::kDeep ? std::optional(usual_surface_m_) : std::nullopt;
      schedule_.runs.push_back(
          {schedule_.rows.size(), std::move(*plan.run), alone_s_ * relativeCost(change, radius_ratio)});
    }
    schedule_.rows.push_back(std::move(row));
  }

  const SceneFile& scene_;
  const TrustExtent& extent_;
  double alone_s_, planned_s_ = 0;
  double usual_surface_m_ = 0;
  TrustSchedule schedule_;
};

void validate(const TrustExtent& extent) {
  requireInRange("duration_s", extent.duration_s, TrustExtent::kDuration_s);
  requireInRange("specimens", extent.specimens, TrustExtent::kSpecimens);
  requireInRange("minutes", extent.minutes, TrustExtent::kMinutes);
}

}  // namespace

bool TrustExtent::wants(std::string_view what) const {
  return only.empty() || std::ranges::find(only, what) != only.end();
}

double usualDuration(const SceneFile& scene) {
  return scene.hand.motion == HandMotion::kStill ? 2 : scene.hand.period_s;
}

std::vector<TrustRun> firstRuns(const SceneFile& scene) {
  std::vector<TrustRun> runs;
  for (std::size_t specimen = 0; specimen < (hasSeed(scene) ? 2U : 1U); ++specimen) {
    PlannedRun plan = planned(scene, TrustChange::kNone, specimen);
    if (!plan.run) {
      throw Failure(fmt::format("the scene cannot be examined: {}", plan.why_not));
    }
    runs.push_back(std::move(*plan.run));
  }
  return runs;
}

TrustSchedule scheduled(const SceneFile& scene, const TrustExtent& extent, const std::vector<TrustForce>& first) {
  return Scheduler(scene, extent, first).schedule();
}

void take(TrustSchedule& schedule, const TrustScheduled& run, const std::optional<TrustForce>& force,
          const std::string& why_not) {
  TrustForces& row = schedule.rows[run.row];
  row.specimens[run.run.specimen] = force;
  if (!why_not.empty()) {
    row.why_not = why_not;
  }
}

std::optional<SoilTarget> strengthAskedFor(const SceneFile& scene) {
  if (scene.soil_name.empty() || scene.bed.soil.friction != FrictionModel::kContact) {
    return std::nullopt;
  }
  const NamedSoil soil = findSoilOrPreset(scene.soil_name);
  return soil.file ? std::optional(soil.file->target) : std::nullopt;
}

bool fitsStrength(const TrustExtent& extent) {
  constexpr double kShare = 0.25;
  return !extent.only.empty() || kStrength_s <= kShare * budgetOf(extent);
}

TrustVerdict examined(const SceneFile& scene, const TrustExtent& extent, const TrustProgress& progress) {
  validate(extent);
  validate(scene);
  std::vector<TrustForce> first;
  constexpr double kFirst = 0.1;  // its fraction of the progress
  for (const TrustRun& run : firstRuns(scene)) {
    first.push_back(measureForce(run, extent.duration_s, extent.threads, [&](std::string_view what, double fraction) {
      return !progress || progress(what, kFirst / 2 * (fraction + static_cast<double>(first.size())));
    }));
  }
  TrustSchedule schedule = scheduled(scene, extent, first);
  std::mutex mutex;
  bool gave_up = false;
  double done_s = 0, all_s = 0;
  for (const TrustScheduled& run : schedule.runs) {
    all_s += run.length_s;
  }
  inParallel(schedule.runs.size(), extent.threads, [&](std::size_t i) {
    const TrustScheduled& run = schedule.runs[i];
    const TrustProgress tell = [&](std::string_view what, double fraction) {
      const std::scoped_lock lock(mutex);
      gave_up =
          gave_up || (progress && !progress(what, kFirst + (1 - kFirst) * (done_s + fraction * run.length_s) / all_s));
      return !gave_up;
    };
    std::optional<TrustForce> force;
    std::string why_not;
    try {
      force = measureForce(run.run, extent.duration_s, 1, tell);
    } catch (const Failure& failure) {
      if (const std::scoped_lock lock(mutex); gave_up) {
        throw;
      }
      why_not = failure.what();
    } catch (const InvalidParameter& refused) {
      why_not = refused.what();
    }
    const std::scoped_lock lock(mutex);
    done_s += run.length_s;
    take(schedule, run, force, why_not);
  });
  std::optional<TrustStrength> strength;
  if (const auto target = strengthAskedFor(scene); target && extent.wants("strength") && fitsStrength(extent)) {
    strength = measureStrength(scene.bed.soil, *target, scene.bed.gravity_m_s2.norm(), extent.threads, progress);
  }
  return judgeTrust(scene, schedule.rows, strength);
}

}  // namespace haptolith

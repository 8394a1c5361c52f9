#include "haptolith/identify/check/parts_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <thread>

#include "haptolith/core/process/in_parallel.h"
#include "haptolith/core/statistics.h"

namespace haptolith {

namespace {

constexpr double kProbeNoise_n = 0.05;

int heldBy(const SoilBelief& belief, const SoilState& truth) {
  const double tool_deg = std::atan(truth.tool_friction) * 180 / std::numbers::pi;
  return (holds(belief.friction_angle_deg, truth.friction_angle_deg) ? 1 : 0) +
         (holds(belief.cohesion_pa, truth.cohesion_pa) ? 1 : 0) +
         (holds(belief.tool_friction_angle_deg, tool_deg) ? 1 : 0);
}

}  // namespace

std::optional<double> PartsCourse::timeUntil(const SoilWidths& wanted) const {
  const auto step =
      std::ranges::find_if(steps, [&](const PartsStep& at) { return isNarrow(widthsOf(at.belief), wanted); });
  return step == steps.end() ? std::nullopt : std::optional(step->time_s);
}

PartsCheck::PartsCheck(const Training& training, std::size_t every)
    : training_(training),
      temper_(SoilIdentifier(training).temper()),
      parts_(partsOf(training.movement, ForceEmulator(training))) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < training.runs.size(); ++i) {
    if (training.runs[i].strength && count++ % every == 0) {
      sheared_.push_back(i);
      others_.emplace_back(training, i);
    }
  }
}

double PartsCheck::duration() const {
  double sum_s = 0;
  for (const MovementPart& part : parts_) {
    sum_s += part.movement.duration();
  }
  return sum_s;
}

PartsCourse PartsCheck::courseOf(std::size_t place, PartOrder order) const {
  const TrainingRun& run = training_.runs[sheared_[place]];
  const ForceEmulator& emulator = others_[place];
  const double gravity_m_s2 = training_.gravity_m_s2;
  const MeasuredForces all = measuredForces(run, kProbeNoise_n, run.number);
  MeasuredForces forces(all.size());
  std::mt19937_64 random(run.number);
  PartsCourse course{measuredState(run), widthsOf(beliefOf(forces, emulator, temper_, gravity_m_s2)), {}};
  double time_s = 0;
  while (course.steps.size() < parts_.size()) {
    const std::vector<PartGain> gains = expectedGains(parts_, emulator, temper_, forces, gravity_m_s2);
    auto next = gains.begin();
    if (order == PartOrder::kAsLearned) {
      next = std::ranges::min_element(gains, {}, &PartGain::part);
    } else if (order == PartOrder::kAtRandom) {
      next += static_cast<std::ptrdiff_t>(random() % gains.size());
    }
    const MovementPart& part = parts_[next->part];
    for (std::size_t window = part.first_window; window < part.first_window + part.windows; ++window) {
      forces[window] = all[window];
    }
    time_s += part.movement.duration();
    course.steps.push_back({next->part, time_s, beliefOf(forces, emulator, temper_, gravity_m_s2), next->widths});
  }
  return course;
}

std::vector<PartsCourse> PartsCheck::courses(PartOrder order) const {
  std::vector<PartsCourse> all(sheared_.size());
  const auto threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  inParallel(all.size(), threads, [&](std::size_t i) { all[i] = courseOf(i, order); });
  return all;
}

std::vector<PartsRow> partsRows(const std::vector<PartsCourse>& courses) {
  std::vector<PartsRow> rows;
  for (std::size_t step = 0; step < courses.front().steps.size(); ++step) {
    PartsRow row;
    row.parts = step + 1;
    std::array<std::vector<double>, 3> widths, ratios;
    int held = 0, near = 0;
    for (const PartsCourse& course : courses) {
      const PartsStep& at = course.steps[step];
      held += heldBy(at.belief, course.truth);
      const SoilWidths came = widthsOf(at.belief);
      for (std::size_t i = 0; i < kWidths.size(); ++i) {
        const double ratio = came.*kWidths[i] / (at.expected.*kWidths[i]);
        widths[i].push_back(came.*kWidths[i]);
        ratios[i].push_back(ratio);
        near += ratio > 0.75 && ratio < 1.25 ? 1 : 0;
      }
    }
    const double intervals = 3 * static_cast<double>(courses.size());
    row.held_share = held / intervals;
    row.within_quarter = near / intervals;
    for (std::size_t i = 0; i < kWidths.size(); ++i) {
      row.median.*kWidths[i] = median(widths[i]);
      row.over_expected.*kWidths[i] = median(ratios[i]);
    }
    rows.push_back(row);
  }
  return rows;
}

TimeUntil timeUntil(const std::vector<PartsCourse>& courses, const SoilWidths& wanted, double most_s) {
  TimeUntil until;
  for (const PartsCourse& course : courses) {
    const std::optional<double> time_s = course.timeUntil(wanted);
    until.mean_s += time_s.value_or(most_s) / static_cast<double>(courses.size());
    until.soils += time_s ? 1 : 0;
  }
  return until;
}

}  // namespace haptolith

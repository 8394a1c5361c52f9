#include "haptolith/study/study_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/fit.h"
#include "haptolith/study/answers.h"

namespace haptolith {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The value below which `share` of them lie.
double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], place - static_cast<double>(below));
}

void validate(const StudyBlock& block, const std::vector<StudySize>& sizes, const PlanParameters& parameters) {
  if (block.procedure != ProcedureKind::kConstant || !fitOptionsOf(block).threshold) {
    throw InvalidParameter("block", block.name, "one of constant stimuli with values above 0");
  }
  for (const StudySize& size : sizes) {
    requireInRange("participants", size.participants, {1, 10'000});
    requireInRange("repeats", size.repeats, {1, 1000});
  }
  validate(parameters.observer);
  requireInRange("spread", parameters.spread, {0, 5});
  requireInRange("against", parameters.against.value_or(1), {0, kInfinity, Ends::kOpen});
  requireInRange("studies", parameters.studies, {10, 100'000});
}

Fit simulatedStudy(const StudyBlock& block, const StudySize& size, const PlanParameters& parameters,
                   std::mt19937_64& random) {
  std::vector<Level> answers;
  for (int person = 0; person < size.participants; ++person) {
    ObserverParameters who = parameters.observer;
    who.weber_fraction *= std::exp(parameters.spread * normal(random));
    SimulatedObserver observer(who, random());
    for (int repeat = 0; repeat < size.repeats; ++repeat) {
      for (const Stimulus& level : block.levels) {
        answers.push_back({level.value, observer.saysMore(level.value, block.reference.value) ? 1.0 : 0.0, 1});
      }
    }
  }
  FitOptions options = fitOptionsOf(block);
  options.confidence = parameters.confidence;
  options.simulations = 0;
  return fitPsychometric(answers, options);
}

}  // namespace

std::vector<PlanOutcome> planStudy(const StudyBlock& block, const std::vector<StudySize>& sizes,
                                   const PlanParameters& parameters, const std::function<bool()>& goes_on) {
  validate(block, sizes, parameters);
  std::vector<PlanOutcome> outcomes;
  for (const StudySize& size : sizes) {
    std::mt19937_64 random(parameters.seed);
    std::vector<double> estimates, ratios;
    int covered = 0, told = 0;
    for (int study = 0; study < parameters.studies; ++study) {
      const Estimate w = simulatedStudy(block, size, parameters, random).weber_fraction;
      estimates.push_back(w.value);
      ratios.push_back(w.interval.high / w.interval.low);
      const auto holds = [&w](double value) { return w.interval.low <= value && value <= w.interval.high; };
      covered += holds(parameters.observer.weber_fraction) ? 1 : 0;
      told += parameters.against && !holds(*parameters.against) ? 1 : 0;
      if (goes_on && !goes_on()) {
        throw Failure("interrupted");
      }
    }
    PlanOutcome outcome{.size = size,
                        .answers = size.participants * size.repeats * static_cast<int>(block.levels.size()),
                        .median = quantile(estimates, 0.5),
                        .low = quantile(estimates, 0.025),
                        .high = quantile(estimates, 0.975),
                        .interval_ratio = quantile(ratios, 0.5),
                        .covered = static_cast<double>(covered) / parameters.studies,
                        .power = std::nullopt};
    if (parameters.against) {
      outcome.power = static_cast<double>(told) / parameters.studies;
    }
    outcomes.push_back(outcome);
  }
  return outcomes;
}

}  // namespace haptolith

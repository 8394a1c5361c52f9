#include "haptolith/study/run/study_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/core/statistics.h"
#include "haptolith/psychometrics/group/group.h"
#include "haptolith/psychometrics/psychometric_figure.h"
#include "haptolith/study/results/answers.h"

namespace haptolith {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kConfidence = 0.95;   // for intervals from simulations
constexpr double kCloseEnough = 0.05;  // relative tolerance of the number of participants

void validate(const StudyBlock& block, const std::vector<StudySize>& sizes, const PlanParameters& parameters) {
  if (block.procedure != ProcedureKind::kConstant || !isWeber(fitOptionsOf(block).sigmoid)) {
    throw InvalidParameter("block", block.name, "one of constant stimuli with values above 0");
  }
  for (const StudySize& size : sizes) {
    requireInRange("participants", size.participants, {1, 10'000});
    requireInRange("repeats", size.repeats, {1, 1000});
  }
  validate(parameters.observer);
  requireInRange("between_sd", parameters.between_sd, {0, 5});
  requireInRange("alternative", parameters.alternative.value_or(1), {0, kInfinity, Ends::kOpen});
  requireInRange("width", parameters.width.value_or(1), {0, kInfinity, Ends::kOpen});
  requireInRange("studies", parameters.studies, {10, 100'000});
}

std::vector<std::vector<Level>> simulatedAnswersOf(const StudyBlock& block, const StudySize& size,
                                                   const PlanParameters& parameters, std::mt19937_64& random) {
  std::vector<std::vector<Level>> people;
  people.reserve(static_cast<std::size_t>(size.participants));
  for (int person = 0; person < size.participants; ++person) {
    ObserverParameters who = parameters.observer;
    who.weber_fraction *= std::exp(parameters.between_sd * normal(random));
    SimulatedObserver observer(who, random());
    std::vector<Level>& answers = people.emplace_back();
    for (int repeat = 0; repeat < size.repeats; ++repeat) {
      for (const Stimulus& level : block.levels) {
        answers.push_back({level.value, observer.saysMore(level.value, block.reference.value) ? 1.0 : 0.0, 1});
      }
    }
  }
  return people;
}

Estimate weberFractionOf(const StudyBlock& block, const std::vector<std::vector<Level>>& people, double confidence) {
  FitOptions options = fitOptionsOf(block);
  options.confidence = confidence;
  options.simulations = 0;
  return people.size() == 1 ? fitPsychometric(people.front(), options).weber_fraction
                            : fitGroup(people, groupOptions(options), Effort::kQuick).scale.median;
}

/// Fraction of studies with a property.
class Counter {
 public:
  explicit Counter(int studies) : studies_(studies) {}

  void count(bool holds) { holding_ += holds ? 1 : 0; }
  [[nodiscard]] SimulatedShare share() const {
    return {holding_ / studies_, wilsonInterval(holding_, studies_, kConfidence)};
  }

 private:
  double studies_;
  double holding_ = 0;
};

bool tells(const Interval& interval, double truth, double alternative) {
  const bool below = interval.high < alternative;
  const bool above = interval.low > alternative;
  return truth < alternative ? below : truth > alternative ? above : below || above;
}

PlanOutcome planOf(const StudyBlock& block, const StudySize& size, const PlanParameters& parameters,
                   const std::function<bool()>& goes_on) {
  const double truth = parameters.observer.weber_fraction;
  std::mt19937_64 random(parameters.seed);
  std::vector<double> estimates, widths;
  Counter covered(parameters.studies), told(parameters.studies), narrow(parameters.studies);
  for (int study = 0; study < parameters.studies; ++study) {
    const Estimate w =
        weberFractionOf(block, simulatedAnswersOf(block, size, parameters, random), parameters.confidence);
    estimates.push_back(w.value);
    widths.push_back((w.interval.high - w.interval.low) / w.value);
    covered.count(w.interval.low <= truth && truth <= w.interval.high);
    told.count(parameters.alternative && tells(w.interval, truth, *parameters.alternative));
    narrow.count(parameters.width && widths.back() <= *parameters.width);
    if (goes_on && !goes_on()) {
      throw Failure("interrupted");
    }
  }
  return {.size = size,
          .answers = size.participants * size.repeats * static_cast<int>(block.levels.size()),
          .median = quantile(estimates, 0.5),
          .low = quantile(estimates, 0.025),
          .high = quantile(estimates, 0.975),
          .interval_width = quantile(widths, 0.5),
          .covered = covered.share(),
          .power = parameters.alternative ? std::optional(told.share()) : std::nullopt,
          .narrow = parameters.width ? std::optional(narrow.share()) : std::nullopt};
}

}  // namespace

std::vector<PlanOutcome> planStudy(const StudyBlock& block, const std::vector<StudySize>& sizes,
                                   const PlanParameters& parameters, const std::function<bool()>& goes_on) {
  validate(block, sizes, parameters);
  std::vector<PlanOutcome> outcomes;
  outcomes.reserve(sizes.size());
  for (const StudySize& size : sizes) {
    outcomes.push_back(planOf(block, size, parameters, goes_on));
  }
  return outcomes;
}

const SimulatedShare& successOf(const PlanOutcome& outcome) {
  return outcome.power ? *outcome.power : *outcome.narrow;
}

std::vector<PlanOutcome> leastParticipants(const StudyBlock& block, int repeats, const PlanParameters& parameters,
                                           double share, const std::function<bool()>& goes_on) {
  requireInRange("power", share, {0, 1, Ends::kOpen});
  validate(block, {{1, repeats}}, parameters);
  if (!parameters.alternative && !parameters.width) {
    throw InvalidParameter("alternative", "nothing", "another Weber fraction; or set the target width of the interval");
  }
  std::map<int, PlanOutcome> tried;
  const auto suffices = [&](int participants) {
    const PlanOutcome outcome = planOf(block, {participants, repeats}, parameters, goes_on);
    return successOf(tried.emplace(participants, outcome).first->second).value >= share;
  };
  int too_few = 1;
  int enough = 4;
  while (!suffices(enough)) {
    if (enough == kMostParticipants) {
      throw Failure(
          fmt::format("{} participants are not sufficient: {:.0f} % of the simulated studies reach the target", enough,
                      100 * successOf(tried.at(enough)).value));
    }
    too_few = enough;
    enough = std::min(2 * enough, kMostParticipants);
  }
  while (enough - too_few > std::max(1.0, kCloseEnough * enough)) {
    const int middle = (too_few + enough) / 2;
    (suffices(middle) ? enough : too_few) = middle;
  }
  std::vector<PlanOutcome> outcomes;
  outcomes.reserve(tried.size());
  for (const auto& [participants, outcome] : tried) {
    outcomes.push_back(outcome);
  }
  return outcomes;
}

}  // namespace haptolith

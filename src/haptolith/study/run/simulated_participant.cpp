#include "haptolith/study/run/simulated_participant.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/study/protocol/groups.h"

namespace haptolith {

namespace {

constexpr double kCertain = std::numeric_limits<double>::infinity();

/// Draws a number between 0 and 1, both excluded.
double share(std::mt19937_64& random) {
  return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53;
}

/// Returns a valid answer.
std::string answerTo(const FormItem& item) {
  switch (item.kind) {
    case FormItem::Kind::kText: return "simulated";
    case FormItem::Kind::kChoice: return item.choices.front();
    case FormItem::Kind::kYesNo: return "no";
    case FormItem::Kind::kNumber:
    case FormItem::Kind::kScale: return fmt::format("{:.0f}", 0.5 * (item.low + item.high));
  }
  return "";
}

/// Returns an answer in a randomly drawn part (stratum) of the item.
std::string anyAnswerTo(const FormItem& item, std::mt19937_64& random) {
  const std::vector<std::string> parts = stratumParts(item);
  const std::size_t part = drawn(random, parts.size());
  if (item.cut_points.empty()) {
    return parts[part];
  }
  const bool lowest = part == 0;
  const double cut = item.cut_points[lowest ? 0 : part - 1];  // the limit belongs to the upper part
  return fmt::format("{}", !lowest ? cut : item.low < item.high ? item.low : cut - 1);
}

double judged(const TrialSummary& summary, JudgedBy by) {
  switch (by) {
    case JudgedBy::kMeanForce: return summary.mean_force_n;
    case JudgedBy::kPeakForce: return summary.peak_force_n;
    default: return summary.work_j;
  }
}

}  // namespace

void validate(const ObserverParameters& observer) {
  requireInRange("weber_fraction", observer.weber_fraction, {0, kCertain, Ends::kOpen});
  requireInRange("bias", observer.bias, {-1, kCertain, Ends::kOpen});
  requireInRange("lapse", observer.lapse, {0, 0.5});
  requireInRange("learning", observer.learning, {0, kCertain});
  requireInRange("group_factor", observer.group_factor, {0, kCertain, Ends::kOpen});
  requireInRange("learning_trials", observer.learning_trials, {0, kCertain, Ends::kOpen});
}

void requireRatios(const StudyProtocol& protocol, JudgedBy by) {
  for (const StudyBlock& block : protocol.blocks) {
    if (by != JudgedBy::kValue || block.teleop) {
      continue;
    }
    std::vector<double> values{block.reference.value};
    for (const Stimulus& level : block.levels) {
      values.push_back(level.value);
    }
    for (const double value : values) {
      if (!(value > 0)) {
        throw InvalidParameter(fmt::format("block {}: value of a stimulus", block.name), fmt::format("{:g}", value),
                               "above 0: a simulated observer judges ratios; use stimuli with positive values, or "
                               "judge a quantity of the hand (--motion, --judge)");
      }
    }
  }
}

double normal(std::mt19937_64& random) {
  const double radius = std::sqrt(-2 * std::log(share(random)));
  return radius * std::cos(2 * std::numbers::pi * share(random));
}

SimulatedObserver::SimulatedObserver(const ObserverParameters& observer, std::uint64_t seed)
    : observer_(observer), random_(seed) {
  validate(observer);
}

bool SimulatedObserver::saysMore(double test, double reference, double factor) {
  if (!(test > 0) || !(reference > 0)) {
    throw InvalidParameter("stimulus", fmt::format("{:g} against {:g}", test, reference),
                           "two values above 0: a simulated observer judges ratios");
  }
  const double learnt = std::exp(-trials_++ / observer_.learning_trials);
  const double w = factor * observer_.weber_fraction * (1 + observer_.learning * learnt);
  const double noise = std::log1p(w) / std::numbers::sqrt2;
  const double sensed_test = std::log(test) + std::log1p(observer_.bias) + noise * normal(random_);
  const double sensed_reference = std::log(reference) + noise * normal(random_);
  const bool is_blind = share(random_) < 2 * observer_.lapse;
  const bool guess = share(random_) < 0.5;
  return is_blind ? guess : sensed_test > sensed_reference;
}

void SimulatedParticipant::takePart(Conductor& conductor) {
  constexpr int kMostSteps = 1'000'000;
  for (int i = 0; i < kMostSteps && !conductor.over(); ++i) {
    if (const StudyState now = conductor.state(); now.paused) {
      throw Failure(now.problem);
    }
    step(conductor);
    conductor.poll();
  }
}

void SimulatedParticipant::step(Conductor& conductor) {
  const StudyState now = conductor.state();
  now_s_ += now.remaining_s.value_or(1);
  switch (now.phase) {
    case StudyPhase::kConsent:
    case StudyPhase::kInstructions:
    case StudyPhase::kBreak: return conductor.proceed();
    case StudyPhase::kInterval:
      if (!now.remaining_s) {
        conductor.proceed();
      }
      return;
    case StudyPhase::kQuestion:
      now_s_ += 1 - now.remaining_s.value_or(1);  // after 1 s, for any limit
      return conductor.answer(choose(conductor, now));
    case StudyPhase::kForm: {
      std::map<std::string, std::string> values;
      const StudyProtocol& protocol = conductor.store().protocol();
      const std::vector<std::string>& strata = protocol.assignment.strata;
      for (const FormItem& item : *now.form) {
        const bool parts = now.form == &protocol.demographics && std::ranges::find(strata, item.key) != strata.end();
        values[item.key] = parts ? anyAnswerTo(item, stratum_random_) : answerTo(item);
        if (now.block != nullptr && now.block->teleop && item.kind == FormItem::Kind::kScale && item.key == kTrustKey) {
          values[item.key] = fmt::format("{:.0f}", trust(item, conductor.trials(), now.block->name));
        }
      }
      return conductor.fill(values);
    }
    default: now_s_ += 2; return;
  }
}

double SimulatedParticipant::trust(const FormItem& item, const std::vector<TrialRow>& trials,
                                   const std::string& block) {
  constexpr double kSpread = 0.1;
  double sum = 0, count = 0;
  for (const TrialRow& trial : trials) {
    const bool is_of_it = trial.block_name == block && trial.state == TrialState::kAnswered && trial.answer &&
                          trial.answer->teleop && std::isfinite(trial.answer->teleop->force_error);
    sum += is_of_it ? trial.answer->teleop->force_error : 0;
    count += is_of_it ? 1 : 0;
  }
  const double truth = count == 0 ? 0.5 : 1 - sum / count;
  return item.low + (item.high - item.low) * std::clamp(truth + kSpread * normal(trust_random_), 0.0, 1.0);
}

int SimulatedParticipant::choose(const Conductor& conductor, const StudyState& now) {
  const ShownTrial& trial = *now.now;
  double test = trial.test->value;
  double reference = trial.block->reference.value;
  if (by_ != JudgedBy::kValue) {
    const std::array<TrialSummary, 2> summaries = conductor.summaries();
    test = judged(summaries[trial.test_first ? 0 : 1], by_);
    reference = judged(summaries[trial.test_first ? 1 : 0], by_);
    if (!(test > 0 && reference > 0)) {
      throw Failure(
          fmt::format("block {}: the test gave {:g} and the reference {:g}, and a simulated observer judges ratios; "
                      "use another --motion or --judge",
                      trial.block->name, test, reference));
    }
  }
  const std::vector<ParticipantGroup>& groups = conductor.store().protocol().groups;
  const auto group = std::ranges::find(groups, now.group, &ParticipantGroup::name);
  const double groups_before = group == groups.end() ? 0 : static_cast<double>(group - groups.begin());
  const bool more = observer_.saysMore(test, reference, std::pow(group_factor_, groups_before));
  return more != trial.test_first ? 1 : 0;
}

}  // namespace haptolith

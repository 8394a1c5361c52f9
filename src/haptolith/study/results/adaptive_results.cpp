#include "haptolith/study/results/adaptive_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/adaptive/quest_plus.h"
#include "haptolith/psychometrics/adaptive/staircase.h"
#include "haptolith/psychometrics/psychometric_function.h"
#include "haptolith/study/protocol/sequence.h"
#include "haptolith/study/results/answers.h"

namespace haptolith {

namespace {

constexpr int kThresholds = 85;

/// Maximum distance between the point of equality and the reference, in JNDs. Beyond it one of the two staircases has
/// no errors, and the estimated Weber fraction is too small (haptolith_adaptive_coverage).
constexpr double kMostShift = 0.5;

std::vector<double> valuesOf(const StudyBlock& block) {
  std::vector<double> values;
  std::ranges::transform(block.levels, std::back_inserter(values), &Stimulus::value);
  return values;
}

bool looksForEquality(const StudyBlock& block) {
  return block.procedure == ProcedureKind::kStaircase && block.staircase.target == StaircaseTarget::kEquality;
}

/// Returns minimum and maximum threshold among the hypotheses.
std::pair<double, double> thresholdsOf(const QuestPlus& quest) {
  const auto threshold = [](const Hypothesis& hypothesis) { return hypothesis.function.threshold; };
  const auto& [low, high] = std::ranges::minmax_element(quest.hypotheses(), {}, threshold);
  return {low->function.threshold, high->function.threshold};
}

/// Returns QUEST+ before the first response, with the grid of the posterior: the procedure's grid, for staircases the
/// default one. Default thresholds are on a finer grid than that for choosing stimuli. The interval of a
/// participant with a small Weber fraction is narrower than the coarse steps.
std::unique_ptr<QuestPlus> posteriorOf(const StudyBlock& block) {
  const std::vector<double> levels = valuesOf(block);
  QuestPlusOptions options = block.quest_plus;
  if (block.procedure == ProcedureKind::kStaircase) {
    options = {.sigmoid = levels.front() > 0 && block.reference.value > 0 ? Sigmoid::kWeber : Sigmoid::kNorm};
  }
  std::unique_ptr<QuestPlus> quest = makeQuestPlus(options, levels, block.reference.value);
  if (!options.thresholds.empty()) {
    return quest;
  }
  const PsychometricFunction& axis = quest->hypotheses().front().function;
  const auto [low, high] = looksForEquality(block) ? std::pair(levels.front(), levels.back()) : thresholdsOf(*quest);
  for (int i = 0; i < kThresholds; ++i) {
    const double share = static_cast<double>(i) / (kThresholds - 1);
    options.thresholds.push_back(fromAxis(axis, std::lerp(toAxis(axis, low), toAxis(axis, high), share)));
  }
  return makeQuestPlus(options, levels, block.reference.value);
}

/// Range of the levels as seen from the reference: the nearest and the farthest level, each on its less favourable
/// side.
struct Reach {
  const Stimulus* nearest = nullptr;
  const Stimulus* farthest = nullptr;
  double nearest_distance = 0, farthest_distance = std::numeric_limits<double>::infinity();  // distances on the axis
};

Reach reachOf(const StudyBlock& block, const PsychometricFunction& function) {
  Reach reach;
  for (const bool above : {false, true}) {
    const Stimulus* nearest = nullptr;
    const Stimulus* farthest = nullptr;
    const auto distance = [&](const Stimulus& level) {
      return std::abs(toAxis(function, level.value) - toAxis(function, block.reference.value));
    };
    for (const Stimulus& level : block.levels) {
      if (level.value != block.reference.value && (level.value > block.reference.value) == above) {
        nearest = nearest == nullptr || distance(level) < distance(*nearest) ? &level : nearest;
        farthest = farthest == nullptr || distance(level) > distance(*farthest) ? &level : farthest;
      }
    }
    if (nearest != nullptr && distance(*nearest) > reach.nearest_distance) {
      reach.nearest = nearest;
      reach.nearest_distance = distance(*nearest);
    }
    if (farthest != nullptr && distance(*farthest) < reach.farthest_distance) {
      reach.farthest = farthest;
      reach.farthest_distance = distance(*farthest);
    }
  }
  return reach;
}

/// Returns a warning about an estimate; empty without one.
std::string remarkOn(const StudyBlock& block, const PsychometricFunction& function, std::string_view measure) {
  const double sigma = toAxis(function, function.threshold + jndOf(function)) - toAxis(function, function.threshold);
  const double shift = std::abs(toAxis(function, function.threshold) - toAxis(function, block.reference.value));
  if (block.procedure == ProcedureKind::kStaircase && shift > kMostShift * sigma) {
    return fmt::format("the PSE is {:.1f} JNDs from the reference, which the staircases do not cross: {} can be larger",
                       shift / sigma, measure);
  }
  const Reach reach = reachOf(block, function);
  if (reach.farthest != nullptr && sigma >= reach.farthest_distance) {
    return fmt::format("the levels end at {}: {} can be larger", reach.farthest->name, measure);
  }
  if (reach.nearest != nullptr && sigma <= reach.nearest_distance) {
    return fmt::format("no level is closer to the reference than {}: {} can be smaller", reach.nearest->name, measure);
  }
  return "";
}

std::string remarkOnThreshold(const QuestPlus& posterior, double threshold) {
  const auto [least, most] = thresholdsOf(posterior);
  if (least == most || (threshold > least && threshold < most)) {
    return "";
  }
  return fmt::format("the threshold is at the limit of its range, {:.3g} to {:.3g}", least, most);
}

}  // namespace

std::unique_ptr<AdaptiveProcedure> procedureOf(const StudyBlock& block, std::uint64_t seed) {
  switch (block.procedure) {
    case ProcedureKind::kStaircase: {
      StaircaseOptions options = block.staircase;
      options.seed = seed;
      return makeStaircase(options, valuesOf(block), block.reference.value);
    }
    case ProcedureKind::kQuestPlus: return makeQuestPlus(block.quest_plus, valuesOf(block), block.reference.value);
    case ProcedureKind::kConstant: break;
  }
  throw InvalidParameter("procedure", "constant", "staircase or quest+");
}

std::optional<AdaptiveResult> adaptiveResult(const StudyBlock& block, std::uint64_t seed,
                                             std::span<const Level> answers) {
  if (answers.empty()) {
    return std::nullopt;
  }
  const std::unique_ptr<AdaptiveProcedure> procedure = procedureOf(block, seed);
  const std::unique_ptr<QuestPlus> posterior = posteriorOf(block);
  for (const Level& answer : answers) {
    procedure->answer(answer.x, answer.k > 0);
    posterior->answer(answer.x, answer.k > 0);
  }
  AdaptiveResult result{
      .trials = static_cast<int>(answers.size()), .finished = !procedure->next(), .threshold = posterior->threshold()};
  if (block.procedure == ProcedureKind::kStaircase) {
    result.reversals = procedure->estimate();
  }
  result.remark = remarkOnThreshold(*posterior, result.threshold.value);
  if (looksForEquality(block)) {
    return result;
  }
  result.width = posterior->width();
  PsychometricFunction function = posterior->hypotheses().front().function;
  function.threshold = result.threshold.value;
  const auto derived = [&](double (*of)(const PsychometricFunction&)) {
    const auto at = [&](double width) {
      function.width = width;
      return of(function);
    };
    return Estimate{.value = at(result.width->value),
                    .interval = {at(result.width->interval.low), at(result.width->interval.high)}};
  };
  result.jnd = derived(jndOf);
  if (function.log_axis) {
    result.weber_fraction = derived(weberFractionOf);
  }
  const bool compares =
      block.procedure == ProcedureKind::kStaircase || block.quest_plus.design == Design::kEqualAsymptote;
  if (compares && result.remark.empty()) {
    function.width = result.width->value;
    result.remark = remarkOn(block, function, function.log_axis ? "the Weber fraction" : "the JND");
  }
  return result;
}

std::vector<AdaptiveResultOf> adaptiveResults(const StudyStore& study, std::span<const TrialRow> trials) {
  std::vector<AdaptiveResultOf> results;
  const std::vector<StudyBlock>& blocks = study.protocol().blocks;
  for (const ParticipantRow& participant : study.participants()) {
    for (std::size_t number = 0; number < blocks.size(); ++number) {
      if (blocks[number].procedure == ProcedureKind::kConstant) {
        continue;
      }
      std::vector<Level> answers;
      for (const TrialRow& trial : trials) {
        if (trial.participant == participant.id && trial.block == number && counts(trial)) {
          answers.push_back({.x = trial.value, .k = trial.answer->positive ? 1.0 : 0.0, .n = 1});
        }
      }
      const std::uint64_t seed = procedureSeed(study.seed(), participant.number, number);
      if (std::optional<AdaptiveResult> result = adaptiveResult(blocks[number], seed, answers)) {
        results.push_back({participant.id, number, *std::move(result)});
      }
    }
  }
  return results;
}

}  // namespace haptolith

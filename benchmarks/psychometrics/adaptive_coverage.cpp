// Bias of the estimated Weber fraction and coverage of the intervals: staircases and QUEST+ over the levels of
// friction-quest with simulated participants. docs/reports/psychometric-coverage.md has the tables that this prints.
//
//     adaptive_coverage [people]        default: 400 for each Weber fraction

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/results/adaptive_results.h"
#include "haptolith/study/run/simulated_participant.h"

namespace {

using namespace haptolith;

constexpr std::array kWeberFractions{0.05, 0.1, 0.2, 0.29, 0.5, 0.8};

std::vector<Level> answersOf(const StudyBlock& block, const ObserverParameters& who, std::uint64_t seed) {
  SimulatedObserver observer(who, seed + 1'000'000);
  const std::unique_ptr<AdaptiveProcedure> procedure = procedureOf(block, seed);
  std::vector<Level> answers;
  while (const std::optional<double> x = procedure->next()) {
    const bool positive = observer.saysMore(*x, block.reference.value);
    procedure->answer(*x, positive);
    answers.push_back({.x = *x, .k = positive ? 1.0 : 0.0, .n = 1});
  }
  return answers;
}

bool holds(const Interval& interval, double value) {
  return interval.low <= value && value <= interval.high;
}

void tell(const StudyBlock& block, const ObserverParameters& who, int people) {
  const double w = who.weber_fraction;
  const double threshold = block.reference.value / (1 + who.bias);
  double sum = 0, square = 0, log_sum = 0, thresholds = 0, reversals = 0, trials = 0;
  int covered = 0, threshold_covered = 0, remarks = 0, with_reversals = 0;
  for (int person = 0; person < people; ++person) {
    const auto seed = static_cast<std::uint64_t>(person);
    const std::vector<Level> answers = answersOf(block, who, seed);
    const AdaptiveResult result = adaptiveResult(block, seed, answers).value();
    const double found = result.weber_fraction->value;
    sum += found / people;
    square += found * found / people;
    log_sum += std::log(found) / people;
    thresholds += result.threshold.value / people;
    trials += static_cast<double>(answers.size()) / people;
    covered += holds(result.weber_fraction->interval, w) ? 1 : 0;
    threshold_covered += holds(result.threshold.interval, threshold) ? 1 : 0;
    remarks += result.remark.empty() ? 0 : 1;
    if (result.reversals) {
      reversals += result.reversals->jnd / result.reversals->threshold;
      ++with_reversals;
    }
  }
  const double error = std::sqrt((square - sum * sum) / people);
  fmt::print("| {:.2f} | {:.0f} | {:+.1f} ± {:.1f} % | {:+.1f} % | {:.1f} % | {:+.1f} % | {:.1f} % | {:.0f} % | {} |\n",
             w, trials, 100 * (sum / w - 1), 100 * error / w, 100 * (std::exp(log_sum) / w - 1),
             100.0 * covered / people, 100 * (thresholds / threshold - 1), 100.0 * threshold_covered / people,
             100.0 * remarks / people,
             with_reversals > 0 ? fmt::format("{:+.0f} %", 100 * (reversals / with_reversals / w - 1)) : "");
}

void tellAll(std::string_view name, const StudyBlock& block, double bias, int people) {
  fmt::print(
      "\n{}, point of equality shifted by {:.0f} %\n"
      "| w | trials | bias of w, mean | geometric mean | covered | bias of PSE | covered | remark | by reversals |\n"
      "|---|---|---|---|---|---|---|---|---|\n",
      name, 100 * bias);
  for (const double w : kWeberFractions) {
    tell(block, {.weber_fraction = w, .bias = bias}, people);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int people = argc > 1 ? std::atoi(argv[1]) : 400;
  const StudyProtocol protocol = loadProtocolText(findProtocol("friction-quest").text, "friction-quest");
  StudyBlock block = protocol.blocks.front();
  for (const double bias : {0.0, 0.1}) {
    tellAll(fmt::format("QUEST+, {} trials", block.quest_plus.trials), block, bias, people);
  }
  block.procedure = ProcedureKind::kStaircase;
  block.staircase.most_trials = 200;
  for (const auto& [staircases, bias] : {std::pair(1, 0.0), std::pair(2, 0.0), std::pair(1, 0.1)}) {
    block.staircase.staircases = staircases;
    tellAll(fmt::format("{} 2-down-1-up on each side, 8 reversals", staircases), block, bias, people);
  }
  return 0;
}

#include "haptolith/study/results/answers.h"

#include <algorithm>

namespace haptolith {

namespace {

bool isOf(const TrialRow& trial, std::size_t block, std::optional<std::int64_t> participant) {
  return trial.block == block && trial.participant == participant.value_or(trial.participant);
}

bool isAnswered(const TrialRow& trial) {
  return trial.state == TrialState::kAnswered && trial.answer && !trial.answer->timed_out;
}

/// Whether the curve's midpoint is set to the reference: all levels are on one side of it, and the task is
/// two-interval. Equal stimuli then get both responses equally often, and no level determines the midpoint.
bool hasItsMiddleAtTheReference(const StudyBlock& block) {
  const double reference = block.reference.value;
  return block.task == TaskKind::kTwoInterval &&
         (block.levels.front().value >= reference || block.levels.back().value <= reference);
}

}  // namespace

bool counts(const TrialRow& trial) {
  return trial.kind == TrialKind::kMain && isAnswered(trial) && !trial.answer->teleop;
}

std::vector<Level> levelsOf(std::span<const TrialRow> trials, std::size_t block,
                            std::optional<std::int64_t> participant) {
  std::vector<Level> levels;
  for (const TrialRow& trial : trials) {
    if (isOf(trial, block, participant) && counts(trial)) {
      levels.push_back({.x = trial.value, .k = trial.answer->positive ? 1.0 : 0.0, .n = 1});
    }
  }
  return pooled(levels);
}

std::optional<double> caught(std::span<const TrialRow> trials, std::size_t block,
                             std::optional<std::int64_t> participant) {
  int right = 0, all = 0;
  for (const TrialRow& trial : trials) {
    if (isOf(trial, block, participant) && trial.kind == TrialKind::kCatch && isAnswered(trial)) {
      ++all;
      right += trial.answer->correct.value_or(false) ? 1 : 0;
    }
  }
  return all > 0 ? std::optional(static_cast<double>(right) / all) : std::nullopt;
}

FitOptions fitOptionsOf(const StudyBlock& block) {
  const auto positive = [](const Stimulus& stimulus) { return stimulus.value > 0; };
  if (positive(block.reference) && std::ranges::all_of(block.levels, positive)) {
    FitOptions options = weberOptions(block.reference.value);
    if (!hasItsMiddleAtTheReference(block)) {
      options.threshold.reset();
    }
    return options;
  }
  FitOptions options;
  options.design = Design::kEqualAsymptote;
  return options;
}

}  // namespace haptolith

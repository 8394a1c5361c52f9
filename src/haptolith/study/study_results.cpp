#include "haptolith/study/study_results.h"

#include <algorithm>

namespace haptolith {

namespace {

template <class Use>
void forEachAnswer(std::span<const TrialRow> trials, std::size_t block, std::optional<std::int64_t> participant,
                   TrialKind kind, const Use& use) {
  for (const TrialRow& row : trials) {
    if (row.block == block && row.state == TrialState::kAnswered && row.kind == kind && row.answer &&
        !row.answer->timed_out && (!participant || row.participant == *participant)) {
      use(row);
    }
  }
}

}  // namespace

std::vector<Level> levelsOf(std::span<const TrialRow> trials, std::size_t block,
                            std::optional<std::int64_t> participant) {
  std::vector<Level> answers;
  forEachAnswer(trials, block, participant, TrialKind::kMain, [&answers](const TrialRow& row) {
    answers.push_back({.x = row.value, .k = row.answer->positive ? 1.0 : 0.0, .n = 1});
  });
  return pooled(answers);
}

FitOptions fitOptionsOf(const StudyBlock& block) {
  const auto positive = [](const Stimulus& stimulus) { return stimulus.value > 0; };
  if (positive(block.reference) && std::ranges::all_of(block.levels, positive)) {
    return weberOptions(block.reference.value);
  }
  FitOptions options;
  options.design = Design::kEqualAsymptote;
  return options;
}

std::optional<double> caught(std::span<const TrialRow> trials, std::size_t block,
                             std::optional<std::int64_t> participant) {
  int right = 0, all = 0;
  forEachAnswer(trials, block, participant, TrialKind::kCatch, [&](const TrialRow& row) {
    ++all;
    right += row.answer->correct.value_or(false) ? 1 : 0;
  });
  return all > 0 ? std::optional(static_cast<double>(right) / all) : std::nullopt;
}

}  // namespace haptolith

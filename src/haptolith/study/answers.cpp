#include "haptolith/study/answers.h"

namespace haptolith {

bool counts(const TrialRow& trial) {
  return trial.kind == TrialKind::kMain && trial.state == TrialState::kAnswered && trial.answer &&
         !trial.answer->timed_out;
}

std::vector<Level> levelsOf(std::span<const TrialRow> trials, std::size_t block) {
  std::vector<Level> levels;
  for (const TrialRow& trial : trials) {
    if (trial.block == block && counts(trial)) {
      levels.push_back({.x = trial.value, .k = trial.answer->positive ? 1.0 : 0.0, .n = 1});
    }
  }
  return pooled(levels);
}

}  // namespace haptolith

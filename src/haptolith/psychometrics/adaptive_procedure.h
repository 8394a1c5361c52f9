#pragma once

#include <vector>

namespace haptolith {

/// A staircase that goes down after `down` positive answers in a row and up after `up` negative ones.
struct StaircaseOptions {
  int down = 1, up = 1;
  int most_trials = 60;
};

/// QUEST+.
struct QuestPlusOptions {
  int most_trials = 40;
};

}  // namespace haptolith

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "haptolith/psychometrics/levels.h"
#include "haptolith/study/store.h"

namespace haptolith {

/// Whether a trial is a point of a curve: a main one, answered in time and not repeated.
[[nodiscard]] bool counts(const TrialRow& trial);

/// How often the tests of a block were said to have more, by their values, the smallest first.
/// @param block  of the protocol's blocks.
[[nodiscard]] std::vector<Level> levelsOf(std::span<const TrialRow> trials, std::size_t block);

}  // namespace haptolith

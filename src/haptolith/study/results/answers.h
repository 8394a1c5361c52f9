#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/levels.h"
#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// Whether a trial contributes to a curve: a main trial with a comparison, answered in time and not repeated.
[[nodiscard]] bool counts(const TrialRow& trial);

/// Counts the positive responses in a block by the value of the test, in ascending order.
/// @param block        index in the protocol's blocks.
/// @param participant  ParticipantRow::id; none: all participants together.
[[nodiscard]] std::vector<Level> levelsOf(std::span<const TrialRow> trials, std::size_t block,
                                          std::optional<std::int64_t> participant = std::nullopt);

/// Returns the fraction of correct responses in the catch trials of a block; none without catch trials.
[[nodiscard]] std::optional<double> caught(std::span<const TrialRow> trials, std::size_t block,
                                           std::optional<std::int64_t> participant = std::nullopt);

/// Returns the default fit for one participant's responses in a block: eq. (22) of icra2021 without lapses, with free
/// Weber fraction and point of subjective equality (PSE). The PSE is fixed at the reference in a two-interval block
/// with all levels on one side of it. A block with values at or below zero has no Weber fraction: its curve is a
/// cumulative Gaussian over a linear axis.
[[nodiscard]] FitOptions fitOptionsOf(const StudyBlock& block);

}  // namespace haptolith

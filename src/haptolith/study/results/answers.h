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

/// Whether a trial is a point of a curve: a main one that compares, answered in time and not repeated.
[[nodiscard]] bool counts(const TrialRow& trial);

/// How often the tests of a block were said to have more, by their values, the smallest first.
/// @param block        of the protocol's blocks.
/// @param participant  whose (ParticipantRow::id); none: everybody's together.
[[nodiscard]] std::vector<Level> levelsOf(std::span<const TrialRow> trials, std::size_t block,
                                          std::optional<std::int64_t> participant = std::nullopt);

/// Share of the catch trials of a block that were answered right; none when there was none.
[[nodiscard]] std::optional<double> caught(std::span<const TrialRow> trials, std::size_t block,
                                           std::optional<std::int64_t> participant = std::nullopt);

/// How one person's answers in a block are fitted unless somebody wants it otherwise: (paper 22) without lapses, with
/// Weber fraction and point of subjective equality free; this is the reference in a two-interval block whose levels all
/// lie on one side of it. A block with values at or below zero has no Weber fraction:
/// its curve is a cumulative Gaussian over a linear axis.
[[nodiscard]] FitOptions fitOptionsOf(const StudyBlock& block);

}  // namespace haptolith

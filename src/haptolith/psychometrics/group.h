#pragma once

#include <optional>
#include <span>
#include <vector>

#include "haptolith/psychometrics/fit.h"

namespace haptolith {

/// How one parameter lies among people, who are taken as normally distributed about a median: of a logarithmic axis the
/// threshold's logarithm, and always the logarithm of the width or Weber fraction.
struct Population {
  Estimate median = {};  ///< of the parameter, in its own unit
  Estimate spread = {};  ///< standard deviation between people: of the logarithm, or of a linear threshold in its unit
  std::vector<Estimate> participants = {};  ///< what each one's answers and the group together say of them
};

/// A group of participants who answered to the same kind of stimuli.
struct GroupFit {
  Fit pooled = {};                                     ///< all answers as if of one person
  std::vector<Fit> participants = {};                  ///< each by themselves
  std::optional<Population> threshold = std::nullopt;  ///< where it is free
  Population scale = {};                               ///< Weber fraction of weber sigmoids, else the width
};

/// Fits each participant, all of them pooled, and a hierarchical model: every participant's parameter comes from a
/// normal distribution whose mean and standard deviation have flat priors, all other parameters are each one's own.
/// Sums over grids, so it is deterministic.
/// @param participants  each one's levels; one participant or more.
/// @throws InvalidParameter as fitPsychometric(), or without a participant.
[[nodiscard]] GroupFit fitGroup(std::span<const std::vector<Level>> participants, const FitOptions& options);

}  // namespace haptolith

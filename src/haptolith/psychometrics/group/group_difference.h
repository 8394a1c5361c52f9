#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/group/group.h"

namespace haptolith {

/// Participant under one or both conditions: their indices among the populations' participants.
struct UnderBoth {
  std::optional<std::size_t> first = {}, second = {};
};

/// Change of a parameter from one condition to another.
struct Change {
  /// Mean over participants of the parameter's place (its logarithm, or itself on a linear axis) under the second
  /// condition, minus that under the first. Places are normally distributed, so the mean is the median's place.
  Estimate mean = {};
  /// Bayes factor for a mean of 0 against one that is normal about 0 with the usual deviation between participants.
  double same = 0;
  SpreadPrior prior = {};  ///< usual deviation between participants
};

/// Estimates the change between two conditions, paired within participants. With places a and b of a participant, (a +
/// b)/2 and b - a are from two normal distributions, so the spread is equal under both. Their means have flat priors;
/// their standard deviations have the wider of the two populations' priors. Participants under only one condition also
/// contribute.
/// @param offset  subtracted from the places under the second condition, such as the difference of their references.
/// @throws InvalidParameter without participants under one of the conditions.
[[nodiscard]] Change changeBetween(const Population& first, const Population& second,
                                   const std::vector<UnderBoth>& people, double confidence, double offset = 0);

/// Estimates the change between two groups without common participants: the difference of the medians of each group's
/// hierarchical model, with independent posteriors.
/// @param offset  subtracted from the places of the second group.
/// @throws InvalidParameter without participants in one of the groups.
[[nodiscard]] Change changeBetweenGroups(const Population& first, const Population& second, double confidence,
                                         double offset = 0);

}  // namespace haptolith

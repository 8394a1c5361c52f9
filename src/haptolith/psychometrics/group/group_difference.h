#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/group/group.h"

namespace haptolith {

/// Somebody who took part under one condition or both: their places among a population's participants.
struct UnderBoth {
  std::optional<std::size_t> first = {}, second = {};
};

/// How a parameter changes from one condition to another.
struct Change {
  /// Mean over people of the parameter's place (its logarithm, or itself on a linear axis) under the second condition,
  /// less that under the first. Places are normally distributed: the mean is the median's place.
  Estimate mean = {};
  /// Bayes factor for a mean of 0 against one that is normal about 0 with the deviation that is usual between people.
  double same = 0;
  SpreadPrior prior = {};  ///< what is usual
};

/// The change between two conditions, paired within people: (a + b)/2 and b - a of everybody's places a and b come from
/// two normal distributions (so people differ equally under both), whose means have flat priors and whose standard
/// deviations have the wider of the two populations' priors. Whoever took part under one condition alone has their
/// share.
/// @param offset  is taken from the places under the second condition, such as the difference of their references.
/// @throws InvalidParameter without anybody under one of the conditions.
[[nodiscard]] Change changeBetween(const Population& first, const Population& second,
                                   const std::vector<UnderBoth>& people, double confidence, double offset = 0);

/// The change from one group of people to another, of whom nobody is in both: the difference of the medians that each
/// group's own hierarchical model finds, whose posteriors are independent.
/// @param offset  is taken from the places of the second group.
/// @throws InvalidParameter without anybody in one of the groups.
[[nodiscard]] Change changeBetweenGroups(const Population& first, const Population& second, double confidence,
                                         double offset = 0);

}  // namespace haptolith

#pragma once

#include <optional>
#include <span>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/group/hierarchy.h"

namespace haptolith {

/// Population distribution of one parameter, normal about a median: for the threshold on its axis (its logarithm on a
/// logarithmic one), and for the logarithm of the width or Weber fraction.
struct Population {
  Estimate median = {};        ///< median of the parameter, in its unit
  Marginal median_place = {};  ///< posterior of the median's place: its logarithm, or itself on a linear axis
  Estimate spread = {};        ///< SD between participants: of the logarithm, or of a linear threshold in its unit
  SpreadPrior prior = {};      ///< prior of the spread
  double alike = 0;            ///< Bayes factor for a spread of 0 against that prior
  std::vector<Estimate> participants = {};  ///< estimate for each from their responses and the group
  /// Marginal likelihood of the parameter's place (its logarithm, or itself on a linear axis) for each participant.
  std::vector<Marginal> likelihoods = {};
};

/// Fit to a group of participants with the same kind of stimuli.
struct GroupFit {
  /// Function of the median participant, with the medians of threshold and width; its levels are those of all
  /// participants. It has no goodness of fit, because it does not describe the responses of one participant.
  Fit median_person = {};
  std::optional<Population> threshold = std::nullopt;  ///< population of the threshold, if it is free
  Population scale = {};               ///< population of the Weber fraction for weber sigmoids, otherwise of the width
  std::vector<Fit> participants = {};  ///< fit of each participant within the group
  /// Separate fit of each participant, with the group's lapse rate; empty for responses to a single stimulus.
  std::vector<std::optional<Fit>> alone = {};
};

/// Returns the options of fitGroup() from those for one participant: the lapse rate is also free; without
/// overdispersion, because individual parameters explain the differences between participants.
[[nodiscard]] FitOptions groupOptions(FitOptions of_one_person);

/// Fits a hierarchical model to all participants. Their thresholds (place on the axis) and ln(width), or ln(Weber
/// fraction) for weber sigmoids, are from two normal distributions. A free lapse rate is common to all. A free guess
/// rate (design yesno) and a free eta are individual. Sums over grids, deterministic.
///
/// Priors:
/// - median threshold: that of a single fit (Model); median logarithm: flat;
/// - standard deviations: half-normal, with 0.6 for the logarithm and a quarter of the stimuli's range for the
/// threshold;
/// - lapse rate: Beta(1, 100); guess rate and eta: those of a single fit.
/// @param participants  levels of each participant; at least one participant.
/// @param effort  kQuick omits the results of single participants.
/// @throws InvalidParameter as fitPsychometric(), or without a participant; Failure when stopAsked().
[[nodiscard]] GroupFit fitGroup(std::span<const std::vector<Level>> participants, const FitOptions& options,
                                Effort effort = Effort::kThorough);

}  // namespace haptolith

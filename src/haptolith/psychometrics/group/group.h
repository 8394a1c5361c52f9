#pragma once

#include <optional>
#include <span>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/group/hierarchy.h"

namespace haptolith {

/// How one parameter lies among people, who are taken as normally distributed about a median: of a logarithmic axis the
/// threshold's logarithm, and always the logarithm of the width or Weber fraction.
struct Population {
  Estimate median = {};        ///< of the parameter, in its own unit
  Marginal median_place = {};  ///< posterior of its place: its logarithm, or itself on a linear axis
  Estimate spread = {};  ///< standard deviation between people: of the logarithm, or of a linear threshold in its unit
  SpreadPrior prior = {};                   ///< of the spread
  double alike = 0;                         ///< Bayes factor for a spread of 0 against that prior
  std::vector<Estimate> participants = {};  ///< what each one's answers and the group together say of them
  /// Each one's likelihood of the parameter's place (its logarithm, or itself on a linear axis), the rest summed over.
  std::vector<Marginal> likelihoods = {};
};

/// A group of participants who answered to the same kind of stimuli.
struct GroupFit {
  /// The function of the person in the middle, whose threshold and width are the medians of people's; its levels are
  /// everybody's. How well it fits is not told: nobody's answers are meant to follow it.
  Fit median_person = {};
  std::optional<Population> threshold = std::nullopt;  ///< where it is free
  Population scale = {};                               ///< Weber fraction of weber sigmoids, else the width
  std::vector<Fit> participants = {};                  ///< each within the group
  /// Each by themselves, with the group's lapse rate; none where the answers are to a single stimulus.
  std::vector<std::optional<Fit>> alone = {};
};

/// What fitGroup() leaves free of a model for one person: the lapse rate too; no overdispersion, as people differ by
/// what is their own.
[[nodiscard]] FitOptions groupOptions(FitOptions of_one_person);

/// A hierarchical model of all participants at once: everybody's threshold (its place on the axis) and ln(width), of
/// weber sigmoids ln(Weber fraction), come from two normal distributions; a free lapse rate is the same for all. The
/// medians of people have the prior of a single fit (Model) for the threshold, a flat one for the logarithm; the
/// standard deviations half-normal ones, of 0.6 for the logarithm and a quarter of the stimuli's range for the
/// threshold; the lapse rate Beta(1, 100); a free guess rate (design yesno) and a free eta are each one's own, with the
/// priors of a single fit. Sums over grids, deterministic.
/// @param participants  each one's levels; one participant or more.
/// @param effort  kQuick leaves out what is said of each participant.
/// @throws InvalidParameter as fitPsychometric(), or without a participant; Failure when stopAsked().
[[nodiscard]] GroupFit fitGroup(std::span<const std::vector<Level>> participants, const FitOptions& options,
                                Effort effort = Effort::kThorough);

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "haptolith/psychometrics/levels.h"
#include "haptolith/psychometrics/psychometric_function.h"

namespace haptolith {

/// Points of Gauss's rule by which the posterior is summed, of each parameter that is free.
struct GridSizes {
  int threshold = 32;
  int width = 32;
  int asymptotes = 12;  ///< of the lapse rate and of the guess rate
  int overdispersion = 10;
  int alone = 80;  ///< of the width, where it is the only free parameter
};

/// Which value stands for the posterior.
enum class PointEstimate {
  kMap,    ///< the most probable one, as psignifit
  kMedian  ///< of each parameter its median: nearly unbiased where w alone is free,
           ///< docs/reports/psychometric-coverage.md
};

/// What is fitted and how. Parameters that are given a value are fixed.
struct FitOptions {
  Sigmoid sigmoid = Sigmoid::kNorm;
  Design design = Design::kYesNo;
  int alternatives = 2;                            ///< of kForcedChoice, at least 2
  bool log_axis = false;                           ///< those of (paper 22) and weibull are logarithmic anyway
  bool falling = false;                            ///< more of the stimulus, fewer positive answers
  std::optional<double> threshold = std::nullopt;  ///< weber: the reference p of (paper 22)
  std::optional<double> lapse = std::nullopt;
  std::optional<double> guess = std::nullopt;            ///< of kYesNo
  std::optional<double> overdispersion = std::nullopt;   ///< eta; 0 is the binomial model
  std::optional<PointEstimate> estimate = std::nullopt;  ///< of weber sigmoids the median, else the most probable
  double confidence = 0.95;
  int simulations = 1000;  ///< for the p value and the band of maximum likelihood; 0 leaves them out
  std::uint64_t seed = 1;  ///< of the simulations
  GridSizes grid = {};
};

/// (paper 22): the Weber fraction w is the only free parameter, p the reference.
[[nodiscard]] FitOptions weberOptions(double reference, Sigmoid sigmoid = Sigmoid::kWeber);

struct Interval {
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

/// A value with its credible or confidence interval; where it was fixed the interval is that value.
struct Estimate {
  double value = 0;
  Interval interval = {};
};

/// Whether a value lies outside its interval: a most probable value at the end of its range does, because the interval
/// leaves out equal tails on both sides.
[[nodiscard]] bool isAtEdge(const Estimate& estimate) noexcept;

enum class FitMethod { kMap, kMedian, kMaximumLikelihood };

/// A psychometric function that has been fitted, docs/reference/psychometrics.md.
struct Fit {
  FitMethod method = FitMethod::kMap;
  Design design = Design::kYesNo;
  int alternatives = 2;            ///< of kForcedChoice
  double confidence = 0.95;        ///< of all intervals
  std::vector<Level> levels = {};  ///< what was fitted, pooled()
  PsychometricFunction function = {};

  Estimate threshold = {};         ///< x50 of the sigmoid; of a comparison, the point of subjective equality
  Estimate width = {};             ///< see PsychometricFunction
  Estimate jnd = {};               ///< x84 - x50
  Estimate weber_fraction = {};    ///< x84/x50 - 1; NaN where the threshold may be 0 or less
  std::optional<Estimate> w = {};  ///< of (paper 22); of weber it is the Weber fraction
  Estimate lapse = {};
  Estimate guess = {};
  Estimate overdispersion = {};  ///< eta, 0 to 1

  double n_trials = 0;
  int free_parameters = 0;
  double deviance = 0;                                        ///< of the binomial model at the estimate
  double p_value = std::numeric_limits<double>::quiet_NaN();  ///< that answers of this function fit worse, simulated
  double p_value_chi_square = std::numeric_limits<double>::quiet_NaN();  ///< the same by the chi-square distribution
  std::string doubt = {};     ///< doubtOf(): a function that these answers contradict
  double log_likelihood = 0;  ///< at the maximum of the likelihood, binomial coefficients left out
  double log_evidence = std::numeric_limits<double>::quiet_NaN();  ///< of the grid; NaN of maximum likelihood
  double aic = 0;
  double bic = 0;

  /// Functions as probable as the posterior (or bootstrap) has them, for bands.
  std::vector<PsychometricFunction> draws = {};
};

/// The most probable (or median) psychometric function and credible intervals, from a posterior on a grid as psignifit
/// computes it (Schuett et al. 2016), refined by NLopt; the intervals are percentiles of the marginals. Deterministic.
/// With w alone free it takes less than a millisecond (without simulations), with all parameters about half a second.
/// @throws InvalidParameter for options or levels that make no sense, for instance a single stimulus where threshold
/// and width are free; Failure when stopAsked().
[[nodiscard]] Fit fitPsychometric(std::span<const Level> levels, const FitOptions& options);

/// The most likely psychometric function, with intervals of the likelihood's profile (profile.h); its draws are
/// `simulations` studies made up from it and fitted again.
/// @throws InvalidParameter as fitPsychometric().
[[nodiscard]] Fit fitMaximumLikelihood(std::span<const Level> levels, const FitOptions& options);

/// The band of psi that the draws of `fit` make up at the stimuli `xs`, each with the confidence of the fit.
[[nodiscard]] std::vector<Interval> credibleBand(const Fit& fit, std::span<const double> xs);

/// The same data under several sigmoids, the most probable (largest log evidence) first.
[[nodiscard]] std::vector<Fit> compareSigmoids(std::span<const Level> levels, const FitOptions& options,
                                               std::span<const Sigmoid> sigmoids);

}  // namespace haptolith

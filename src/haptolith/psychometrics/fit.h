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

/// Numbers of Gauss-Legendre points for the sum of the posterior, for each free parameter.
struct GridSizes {
  int threshold = 32;
  int width = 32;
  int asymptotes = 12;  ///< points for the lapse rate and for the guess rate
  int overdispersion = 10;
  int alone = 80;  ///< points for the width, if it is the only free parameter
};

/// Point estimate of the posterior.
enum class PointEstimate {
  kMap,    ///< most probable value, as in psignifit
  kMedian  ///< marginal medians: nearly unbiased if w alone is free, docs/reports/psychometric-coverage.md
};

/// Model and method of a fit. Parameters with a value are fixed.
struct FitOptions {
  Sigmoid sigmoid = Sigmoid::kNorm;
  Design design = Design::kYesNo;
  int alternatives = 2;                            ///< for kForcedChoice, at least 2
  bool log_axis = false;                           ///< those of (paper 22) and weibull are always logarithmic
  bool falling = false;                            ///< positive responses decrease with the stimulus
  std::optional<double> threshold = std::nullopt;  ///< for weber the reference p of (paper 22)
  std::optional<double> lapse = std::nullopt;
  std::optional<double> guess = std::nullopt;            ///< for kYesNo
  std::optional<double> overdispersion = std::nullopt;   ///< eta; 0 is the binomial model
  std::optional<PointEstimate> estimate = std::nullopt;  ///< default: kMedian for weber sigmoids, otherwise kMap
  double confidence = 0.95;
  int simulations = 1000;  ///< for the p value and the band of maximum likelihood; 0 omits them
  std::uint64_t seed = 1;  ///< seed of the simulations
  GridSizes grid = {};
};

/// Returns the options of (paper 22): the Weber fraction w is the only free parameter, p the reference.
[[nodiscard]] FitOptions weberOptions(double reference, Sigmoid sigmoid = Sigmoid::kWeber);

struct Interval {
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

/// Value with its credible or confidence interval; for a fixed parameter the interval is that value.
struct Estimate {
  double value = 0;
  Interval interval = {};
};

/// Whether a value is outside its interval. This holds for a most probable value at the end of its range, because the
/// interval leaves out equal tails on both sides.
[[nodiscard]] bool isAtEdge(const Estimate& estimate) noexcept;

enum class FitMethod { kMap, kMedian, kMaximumLikelihood };

/// Fitted psychometric function, docs/reference/psychometrics.md.
struct Fit {
  FitMethod method = FitMethod::kMap;
  Design design = Design::kYesNo;
  int alternatives = 2;            ///< for kForcedChoice
  double confidence = 0.95;        ///< level of all intervals
  std::vector<Level> levels = {};  ///< fitted data, pooled()
  PsychometricFunction function = {};

  Estimate threshold = {};         ///< x50 of the sigmoid; in a comparison the point of subjective equality
  Estimate width = {};             ///< see PsychometricFunction
  Estimate jnd = {};               ///< x84 - x50
  Estimate weber_fraction = {};    ///< x84/x50 - 1; NaN if the threshold may be 0 or less
  std::optional<Estimate> w = {};  ///< w of (paper 22); for weber the Weber fraction
  Estimate lapse = {};
  Estimate guess = {};
  Estimate overdispersion = {};  ///< eta, 0 to 1

  double n_trials = 0;
  int free_parameters = 0;
  double deviance = 0;                                        ///< deviance of the binomial model at the estimate
  double p_value = std::numeric_limits<double>::quiet_NaN();  ///< simulated probability of a worse fit
  double p_value_chi_square = std::numeric_limits<double>::quiet_NaN();  ///< that probability by chi-square
  std::string doubt = {};     ///< doubtOf(): contradiction between responses and function
  double log_likelihood = 0;  ///< max. log-likelihood, without binomial coefficients
  double log_evidence = std::numeric_limits<double>::quiet_NaN();  ///< evidence on the grid; NaN for maximum likelihood
  double aic = 0;
  double bic = 0;

  /// Functions drawn from the posterior (or bootstrap), for bands.
  std::vector<PsychometricFunction> draws = {};
};

/// Fits the most probable (or median) psychometric function with credible intervals, from a posterior on a grid as in
/// psignifit (Schuett et al. 2016), refined by NLopt. The intervals are percentiles of the marginals. Deterministic.
/// With w alone free it takes less than 1 ms (without simulations), with all parameters about 0.5 s.
/// @throws InvalidParameter for invalid options or levels, for instance a single stimulus with free threshold and
/// width; Failure when stopAsked().
[[nodiscard]] Fit fitPsychometric(std::span<const Level> levels, const FitOptions& options);

/// Fits the most likely psychometric function, with profile-likelihood intervals (profile.h). Its draws are fits to
/// `simulations` studies simulated from it.
/// @throws InvalidParameter as fitPsychometric().
[[nodiscard]] Fit fitMaximumLikelihood(std::span<const Level> levels, const FitOptions& options);

/// Returns the band of psi from the draws of `fit` at the stimuli `xs`, pointwise with the confidence of the fit.
[[nodiscard]] std::vector<Interval> credibleBand(const Fit& fit, std::span<const double> xs);

/// Fits several sigmoids to the data; the most probable one (max. log evidence) is first.
[[nodiscard]] std::vector<Fit> compareSigmoids(std::span<const Level> levels, const FitOptions& options,
                                               std::span<const Sigmoid> sigmoids);

}  // namespace haptolith

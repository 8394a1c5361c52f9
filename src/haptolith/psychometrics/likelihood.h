#pragma once

#include <span>

#include "haptolith/psychometrics/levels.h"
#include "haptolith/psychometrics/psychometric_function.h"

namespace haptolith {

/// Returns the beta-binomial log-likelihood of k positive responses of n, without the binomial coefficient: the
/// probability of a positive response is Beta-distributed about `psi`.
///
///     ln [ B(k + psi nu, n - k + (1 - psi) nu) / B(psi nu, (1 - psi) nu) ],  nu = 1/eta^2 - 1
///
/// (Schuett, Harmeling, Macke & Wichmann 2016, Vision Research 122, their A.5). eta = 0 is the binomial distribution, k
/// ln psi + (n - k) ln(1 - psi); with eta = 1 all responses are equal. Computed as a product that holds for all eta.
/// @param k, n  whole numbers, 0 <= k <= n. @param psi, eta  0 to 1.
[[nodiscard]] double logLikelihood(double k, double n, double psi, double eta) noexcept;

/// eta^2 below which even many responses cannot be distinguished from binomial ones.
inline constexpr double kBinomial = 1e-9;

/// Returns the sum over the levels; minus infinity if the function excludes a response.
[[nodiscard]] double logLikelihood(std::span<const Level> levels, const PsychometricFunction& function,
                                   double eta) noexcept;

/// Returns twice the log-likelihood of the saturated model, with the probability k/n at each level, minus that of the
/// binomial model; 0 is a perfect fit.
[[nodiscard]] double devianceOf(std::span<const Level> levels, const PsychometricFunction& function) noexcept;

}  // namespace haptolith

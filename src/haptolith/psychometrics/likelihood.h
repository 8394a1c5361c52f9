#pragma once

#include <span>

#include "haptolith/psychometrics/levels.h"
#include "haptolith/psychometrics/psychometric_function.h"

namespace haptolith {

/// Log-likelihood of k positive answers of n where each is positive with a probability that is itself Beta-distributed
/// about `psi`, without the binomial coefficient.
///
///     ln [ B(k + psi nu, n - k + (1 - psi) nu) / B(psi nu, (1 - psi) nu) ],  nu = 1/eta^2 - 1
///
/// (Schuett, Harmeling, Macke & Wichmann 2016, Vision Research 122, their A.5). eta = 0 is the binomial distribution,
/// k ln psi + (n - k) ln(1 - psi); eta = 1 gives all answers alike. Written as a product that holds for all of them.
/// @param k, n  whole numbers, 0 <= k <= n. @param psi, eta  0 to 1.
[[nodiscard]] double logLikelihood(double k, double n, double psi, double eta) noexcept;

/// eta^2 below which many answers cannot be told from binomial ones.
inline constexpr double kBinomial = 1e-9;

/// The sum over the levels; minus infinity where the function excludes what was answered.
[[nodiscard]] double logLikelihood(std::span<const Level> levels, const PsychometricFunction& function,
                                   double eta) noexcept;

/// Twice the log-likelihood that the binomial model falls short of the saturated one, which gives each level its own
/// probability k/n; 0 is a perfect fit.
[[nodiscard]] double devianceOf(std::span<const Level> levels, const PsychometricFunction& function) noexcept;

}  // namespace haptolith

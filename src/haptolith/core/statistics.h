#pragma once

#include <span>
#include <vector>

namespace haptolith {

// Statistics of samples without NaN, in the unit of the values.

/// The arithmetic mean; NaN without values.
[[nodiscard]] double mean(std::span<const double> values) noexcept;

/// The standard deviation of the population that the values are a sample of (divisor n - 1); NaN of fewer than two.
[[nodiscard]] double standardDeviation(std::span<const double> values) noexcept;

/// The median; for an even number of values the mean of the two central ones; NaN without values.
[[nodiscard]] double median(std::vector<double> values);

/// The value below which `fraction` (0 to 1) of the values lie, interpolated between the two nearest (Hyndman and Fan's
/// type 7, R's default); NaN without values.
[[nodiscard]] double quantile(std::vector<double> values, double fraction);

}  // namespace haptolith

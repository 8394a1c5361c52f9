#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace haptolith {

/// The median: the middle one of the values in ascending order, the mean of the two in the middle of an even number of
/// them, in their unit; NaN of none. No value is NaN.
[[nodiscard]] inline double median(std::vector<double> values) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return values.size() % 2 == 1 ? *middle : (*middle + *std::ranges::max_element(values.begin(), middle)) / 2;
}

}  // namespace haptolith

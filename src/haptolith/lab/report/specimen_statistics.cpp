#include "haptolith/lab/report/specimen_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>

#include "haptolith/core/statistics.h"

namespace haptolith {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Formats with a number of decimals; never as -0.
std::string shown(double number, int decimals) {
  const double scale = std::pow(10, decimals);
  return fmt::format("{:.{}f}", std::round(number * scale) / scale + 0.0, decimals);
}

}  // namespace

Scatter scatterOf(const std::vector<double>& numbers) {
  std::vector<double> finite;
  std::ranges::copy_if(numbers, std::back_inserter(finite), [](double number) { return std::isfinite(number); });
  return {mean(finite), standardDeviation(finite), finite.size()};
}

std::string shown(const Scatter& scatter, int decimals) {
  return scatter.specimens == 0  ? "none"
         : scatter.specimens > 1 ? shown(scatter.mean, decimals) + " ± " + shown(scatter.sd, decimals)
                                 : shown(scatter.mean, decimals);
}

Verdict verdictOn(const Finding& finding, double number) {
  return !finding.accepted ? Verdict::kInfo : finding.accepted->contains(number) ? Verdict::kPass : Verdict::kFail;
}

ReportValue overSeeds(const std::vector<Finding>& specimens) {
  const Finding& first = specimens.front();
  std::vector<double> numbers;
  numbers.reserve(specimens.size());
  for (const Finding& finding : specimens) {
    numbers.push_back(finding.number);
  }
  const Scatter scatter = scatterOf(numbers);
  std::string text = shown(scatter, first.decimals);
  if (scatter.specimens == 0) {
    return {text, verdictOn(first, scatter.mean)};
  }
  text += first.unit;
  const std::size_t none = specimens.size() - scatter.specimens;
  if (none > 0) {
    text += fmt::format(" (none with {} of {} seeds)", none, specimens.size());
  }
  return {text, verdictOn(first, none > 0 ? kNone : scatter.mean)};
}

}  // namespace haptolith

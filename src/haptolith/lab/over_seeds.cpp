#include "haptolith/lab/over_seeds.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

namespace haptolith {

namespace {

/// With so many decimals, and never as -0.
std::string shown(double number, int decimals) {
  const double scale = std::pow(10, decimals);
  return fmt::format("{:.{}f}", std::round(number * scale) / scale + 0.0, decimals);
}

}  // namespace

Verdict verdictOn(const Finding& finding, double number) {
  return !finding.accepted ? Verdict::kInfo : finding.accepted->contains(number) ? Verdict::kPass : Verdict::kFail;
}

ReportValue overSeeds(const std::vector<Finding>& specimens) {
  const Finding& first = specimens.front();
  std::vector<double> numbers;
  numbers.reserve(specimens.size());
  for (const Finding& finding : specimens) {
    if (std::isfinite(finding.number)) {
      numbers.push_back(finding.number);
    }
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  if (numbers.empty()) {
    return {"none", verdictOn(first, nan)};
  }
  const auto count = static_cast<double>(numbers.size());
  const double mean = std::accumulate(numbers.begin(), numbers.end(), 0.0) / count;
  std::string text = shown(mean, first.decimals);
  if (numbers.size() > 1) {
    double squares = 0;
    for (const double number : numbers) {
      squares += (number - mean) * (number - mean);
    }
    text += " ± " + shown(std::sqrt(squares / (count - 1)), first.decimals);
  }
  text += first.unit;
  const std::size_t none = specimens.size() - numbers.size();
  if (none > 0) {
    text += fmt::format(" (none with {} of {} seeds)", none, specimens.size());
  }
  return {text, verdictOn(first, none > 0 ? nan : mean)};
}

}  // namespace haptolith

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/report/report_page.h"

namespace haptolith {

/// Mean and standard deviation over specimens.
struct Scatter {
  double mean = 0;            ///< NaN without specimens
  double sd = 0;              ///< standard deviation of one specimen (n - 1); NaN for fewer than two
  std::size_t specimens = 0;  ///< number of specimens with a value
};

/// Returns mean and standard deviation of the finite numbers.
[[nodiscard]] Scatter scatterOf(const std::vector<double>& numbers);

/// Formats with a number of decimals: "41.9 ± 0.4", "41.9" for one specimen, "none" without specimens; never -0.
[[nodiscard]] std::string shown(const Scatter& scatter, int decimals);

/// Returns the verdict on `number` by the accepted range of `finding`: kInfo without a range, kFail for NaN.
[[nodiscard]] Verdict verdictOn(const Finding& finding, double number);

/// Combines a finding of several specimens: "41.9 ± 0.4°", mean and standard deviation (n - 1), or "41.9°" for one. The
/// verdict is that of the mean. If some have no value (NaN), the text states it, the mean is that of the others, and
/// the verdict is a failure. If none has one, the text is "none".
/// @param specimens  one or more findings, which differ only in their numbers.
[[nodiscard]] ReportValue overSeeds(const std::vector<Finding>& specimens);

}  // namespace haptolith

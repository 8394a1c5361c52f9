#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/report/report_page.h"

namespace haptolith {

/// What numbers of several specimens have in common.
struct Scatter {
  double mean = 0;            ///< NaN without any
  double sd = 0;              ///< standard deviation of one specimen (n - 1); NaN of fewer than two
  std::size_t specimens = 0;  ///< that have a number
};

/// Mean and standard deviation of those that are finite.
[[nodiscard]] Scatter scatterOf(const std::vector<double>& numbers);

/// "41.9 ± 0.4" with so many decimals, "41.9" of one specimen, "none" of none; never -0.
[[nodiscard]] std::string shown(const Scatter& scatter, int decimals);

/// Whether `number` is where `finding` accepts it: kInfo when it says nothing of that, kFail for NaN.
[[nodiscard]] Verdict verdictOn(const Finding& finding, double number);

/// The same finding of several specimens: "41.9 ± 0.4°", their mean and standard deviation (n - 1), or "41.9°" of one;
/// the verdict is the mean's. Where some have no number (NaN), the mean is that of the others, says so, and fails;
/// where none has, it is "none".
/// @param specimens  one or more; they differ by their numbers.
[[nodiscard]] ReportValue overSeeds(const std::vector<Finding>& specimens);

}  // namespace haptolith

#pragma once

#include <string>
#include <vector>

#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/report_page.h"

namespace haptolith {

/// Whether `number` is where `finding` accepts it: kInfo when it says nothing of that, kFail for NaN.
[[nodiscard]] Verdict verdictOn(const Finding& finding, double number);

/// The same finding of several specimens: "41.9 ± 0.4°", their mean and standard deviation (n - 1), or "41.9°" of one;
/// the verdict is the mean's. Where some have no number (NaN), the mean is that of the others, says so, and fails;
/// where none has, it is "none".
/// @param specimens  one or more; they differ by their numbers.
[[nodiscard]] ReportValue overSeeds(const std::vector<Finding>& specimens);

}  // namespace haptolith

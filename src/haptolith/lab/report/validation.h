#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"

namespace haptolith {

/// Status of a claim about the simulated soil.
enum class ClaimLight {
  kGreen,   ///< the confidence interval of the mean is inside the tolerance
  kYellow,  ///< the interval contains an end of the tolerance, or there is no interval
  kRed,     ///< the interval is outside the tolerance, or a specimen has no value
};

/// Evidence that a claim gives.
enum class ClaimKind {
  kIndependent,  ///< a measurement, equation or theory to which the soil was not fitted
  kCalibrated,   ///< a target to which the soil was fitted
  kConsistency,  ///< haptolith compared with itself or with mechanics
};

/// A simulated number compared with a reference value.
struct Claim {
  std::string id;         ///< "blade-sand-upright"
  std::string group;      ///< heading on the page
  std::string claim;      ///< quantity and conditions, one line
  std::string reference;  ///< source of the reference value
  std::string unit;       ///< unit of both numbers; may be empty
  std::string note;       ///< explanation of the verdict; may be empty

  ClaimKind kind = ClaimKind::kIndependent;

  std::optional<double> expected = {};  ///< reference number; empty: each specimen has a separate one
  Range scatter{0, 0};                  ///< scatter of the reference; 0 to 0 if the source has none

  // Tolerance; exactly one of them is set.
  std::optional<double> factor = {};   ///< simulated over reference within 1/factor to factor
  std::optional<double> within = {};   ///< simulated over reference within 1 - within to 1 + within
  std::optional<Range> accepted = {};  ///< range of the simulated number
};

/// Result of one specimen for a claim.
struct ClaimSpecimen {
  std::optional<double> ours;   ///< simulated number; empty: no result
  std::optional<double> other;  ///< reference from Claim::expected or for this specimen; empty: no reference
  std::string why_not;          ///< reason for a missing number
};

struct ClaimValue {
  double mean = 0;
  std::optional<double> standard_error;  ///< SD (n - 1) over sqrt(n); empty for a single specimen
};

struct ClaimOutcome {
  ClaimLight light = ClaimLight::kRed;
  std::size_t specimens = 0;            ///< number of specimens with a result
  std::optional<ClaimValue> ours;       ///< simulated mean; empty: no specimen has a result
  std::optional<ClaimValue> other;      ///< reference over all specimens
  std::optional<ClaimValue> ratio;      ///< mean simulated over mean reference; empty for a reference of 0
  std::optional<Range> ratio_range;     ///< tolerance as a range of the ratio; empty for a reference of 0
  std::optional<Range> ratio_interval;  ///< 90 % confidence interval of the mean ratio; empty for fewer than two
  double spread = 0;    ///< SD of one specimen over the reference, or over half the tolerance for a reference of 0
  std::string why_not;  ///< reason of the first specimen without a number
};

/// @throws InvalidParameter for a claim without exactly one tolerance, a factor below 1, a tolerance below 0.
void validate(const Claim& claim);

/// Returns means over specimens, and the verdict of two one-sided t tests at 5 % each (Schuirmann 1987, J.
/// Pharmacokinet. Biopharm. 15, 657): a claim holds if the 90 % confidence interval of the mean is inside the
/// tolerance, and fails if it is outside. A tolerance by a factor is tested with logarithms. A specimen without a
/// number makes it red.
/// @param specimens  at least one.
[[nodiscard]] ClaimOutcome judge(const Claim& claim, const std::vector<ClaimSpecimen>& specimens);

/// Number of specimens added to a claim whose spread is larger than kWideSpread. Looking at the spread first raises the
/// 5 % of a verdict to at most 8 % (simulated in validation_test.cpp).
constexpr std::size_t kMoreSpecimens = 2;
constexpr double kWideSpread = 0.15;

/// Claim with its outcome; empty: not simulated yet.
struct JudgedClaim {
  Claim claim;
  std::optional<ClaimOutcome> outcome;
};

/// Returns the headings of the claims, in their order.
[[nodiscard]] std::vector<std::string> groupsOf(const std::vector<Claim>& claims);

/// Returns the unique file names of their figures: "validation-flow-and-heaps.svg".
[[nodiscard]] std::vector<std::string> figureNamesOf(const std::vector<std::string>& groups);

/// Returns the page in Markdown: a summary by kind of claim, and for each group a table, notes and its figure, which is
/// in the page's folder.
/// @param introduction  paragraphs between the summary and the groups.
[[nodiscard]] std::string validationPage(const std::vector<JudgedClaim>& claims,
                                         const std::vector<std::string>& introduction, bool has_figures);

/// Draws simulated over reference with confidence interval and tolerance, one line per claim of a group that has a
/// ratio.
/// @return false, without a file, if no claim has one. @throws as Figure.
bool drawValidation(const OutputFile& file, const std::vector<JudgedClaim>& claims, std::string_view group);

}  // namespace haptolith

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"

namespace haptolith {

/// How a claim about our soil stands.
enum class ClaimLight {
  kGreen,   ///< within its tolerance
  kYellow,  ///< outside it by at most the tolerance once more, or by at most the scatter of one specimen
  kRed,     ///< further outside, or without a number
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

  std::optional<double> expected = {};  ///< the other number; none: each specimen has one of its own
  Range scatter{0, 0};                  ///< within which the source has it; empty (0 to 0) where it does not say

  // Tolerance; exactly one of them is set.
  std::optional<double> factor = {};   ///< ours over theirs within 1/factor to factor
  std::optional<double> within = {};   ///< ours over theirs within 1 - within to 1 + within
  std::optional<Range> accepted = {};  ///< ours within this
};

/// What one specimen says of a claim.
struct ClaimSpecimen {
  std::optional<double> ours;   ///< none: it gave no number
  std::optional<double> other;  ///< of Claim::expected, or of this specimen; none: there is none
  std::string why_not;          ///< without a number, in words
};

struct ClaimValue {
  double mean = 0;
  std::optional<double> deviation;  ///< standard deviation of one specimen (n - 1); none of a single one
};

struct ClaimOutcome {
  ClaimLight light = ClaimLight::kRed;
  std::size_t specimens = 0;         ///< that gave numbers
  std::optional<ClaimValue> ours;    ///< none: no specimen gave one
  std::optional<ClaimValue> other;   ///< of all specimens
  std::optional<ClaimValue> ratio;   ///< ours over theirs; none where theirs is 0
  std::optional<Range> ratio_range;  ///< the tolerance in terms of the ratio, likewise
  std::string why_not;               ///< of the first specimen without a number
};

/// @throws InvalidParameter for a claim without exactly one tolerance, a factor below 1, a tolerance below 0.
void validate(const Claim& claim);

/// Means over specimens, and how the mean stands. A specimen without a number makes it red.
/// @param specimens  one or more.
[[nodiscard]] ClaimOutcome judge(const Claim& claim, const std::vector<ClaimSpecimen>& specimens);

/// A claim with its outcome; none: not measured yet.
struct JudgedClaim {
  Claim claim;
  std::optional<ClaimOutcome> outcome;
};

/// Headings under which claims stand, in their order.
[[nodiscard]] std::vector<std::string> groupsOf(const std::vector<Claim>& claims);

/// File names of their figures, each another: "validation-flow-and-heaps.svg".
[[nodiscard]] std::vector<std::string> figureNamesOf(const std::vector<std::string>& groups);

/// Returns the page in Markdown: a summary by kind of claim, and for each group a table, notes and its figure, which is
/// in the page's folder.
/// @param introduction  paragraphs between the summary and the groups.
[[nodiscard]] std::string validationPage(const std::vector<JudgedClaim>& claims,
                                         const std::vector<std::string>& introduction, bool has_figures);

/// Ours over theirs with scatter and tolerance, one line for each claim of a group that has a ratio. False, and no
/// file: none has. @throws as Figure.
bool drawValidation(const OutputFile& file, const std::vector<JudgedClaim>& claims, std::string_view group);

}  // namespace haptolith

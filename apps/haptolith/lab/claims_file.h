#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/lab/report/validation.h"

namespace haptolith {

/// A test of the laboratory that a claim is measured with.
struct ClaimRun {
  std::string test;
  std::string soil;
  std::string body = "Earth";
  std::optional<double> radius_mm;  ///< of the macroparticles; none: the test's own
  double stiffness_times = 1;       ///< contacts as many times as stiff as the soil's, at any load
  toml::table options = {};         ///< of the test
};

/// A claim and how it is measured.
struct MeasuredClaim {
  Claim claim;
  ClaimRun run;
  std::optional<ClaimRun> over;      ///< ours is the number of `run` over that of this one
  std::string ours;                  ///< where the number stands in the test's JSON: "/draft_n" (RFC 6901)
  std::string other;                 ///< where that of the theory stands; empty: the claim expects a number
  std::int64_t specimens_times = 1;  ///< as many times as many specimens as asked for
  bool any_soil = false;             ///< whether it is a claim about soil of any kind
};

/// Reads the claims of a file (docs/reference/claims-file.md); its soil files are relative to its folder.
/// @throws TomlError for an invalid line; Failure when it cannot be read.
[[nodiscard]] std::vector<MeasuredClaim> readClaims(const std::filesystem::path& path);

/// Those of validation/.
[[nodiscard]] std::vector<MeasuredClaim> shippedClaims();

}  // namespace haptolith

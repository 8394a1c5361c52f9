#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/lab/report/validation.h"

namespace haptolith {

/// Laboratory test for a claim.
struct ClaimRun {
  std::string test;
  std::string soil;
  std::string body = "Earth";
  std::optional<double> radius_mm;  ///< radius of the particles; empty: the test's default
  double stiffness_times = 1;       ///< contact stiffness over that of the soil, at any load
  toml::table options = {};         ///< options of the test
};

/// Claim with the test that determines its number.
struct MeasuredClaim {
  Claim claim;
  ClaimRun run;
  std::optional<ClaimRun> over;  ///< the simulated number is that of `run` over that of this run
  std::string ours;              ///< JSON pointer (RFC 6901) to the simulated number: "/draft_n"
  std::string other;             ///< JSON pointer to the theory's number; empty: the claim contains one
  bool any_soil = false;         ///< whether the claim holds for any kind of soil
};

/// Reads the claims of a file (docs/reference/claims-file.md); paths of soil files are relative to it. @throws
/// TomlError for invalid content, with its line; Failure if it cannot be read.
[[nodiscard]] std::vector<MeasuredClaim> readClaims(const std::filesystem::path& path);

/// Returns the claims of validation/.
[[nodiscard]] std::vector<MeasuredClaim> shippedClaims();

}  // namespace haptolith

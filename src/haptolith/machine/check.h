#pragma once

#include <string>

namespace haptolith {

/// Result of a check of the machine. Only kInsufficient keeps the loop from doing its work.
enum class Fitness { kOk, kImprovable, kInsufficient };

/// One check of `haptolith doctor`, as text.
struct Check {
  std::string name{};
  Fitness verdict = Fitness::kOk;
  std::string found{};
  std::string needed{};
  std::string remedy{};  ///< the exact remedy; empty when none is needed or possible
};

}  // namespace haptolith

#pragma once

#include <string>

namespace haptolith {

/// What a check of the machine came to. Only kInsufficient keeps the loop from doing its work.
enum class Fitness { kOk, kImprovable, kInsufficient };

/// One thing that `haptolith doctor` looks at, told to a person.
struct Check {
  std::string name{};
  Fitness verdict = Fitness::kOk;
  std::string found{};
  std::string needed{};
  std::string remedy{};  ///< the exact line that mends it; empty when there is nothing to mend, or no way to
};

}  // namespace haptolith

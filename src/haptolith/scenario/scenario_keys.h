#pragma once

#include <span>

#include "haptolith/scenario/scenario.h"
#include "haptolith/scenario/toml/file_keys.h"

namespace haptolith {

using ScenarioKey = FileKey<Scenario>;

/// Every key there is, in the order in which they are applied: what a key builds on stands before it.
[[nodiscard]] std::span<const ScenarioKey> scenarioKeys();

}  // namespace haptolith

#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace haptolith {

/// Describes the differences between two JSON objects: one sentence for each of the first values, then "and N more".
/// Empty when they are equal; order does not matter.
/// @param wording  makes a sentence of the value's path ("body"), its old value and its new value.
[[nodiscard]] std::vector<std::string> differences(const nlohmann::ordered_json& before,
                                                   const nlohmann::ordered_json& now, const std::string& wording);

}  // namespace haptolith

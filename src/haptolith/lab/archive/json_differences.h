#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace haptolith {

/// What differs between two JSON objects: a sentence for each of the first values, then "and N more"; none when they
/// are the same, in whatever order.
/// @param wording  of the sentence: the value's place ("body"), what it was before, what it is now.
[[nodiscard]] std::vector<std::string> differences(const nlohmann::ordered_json& before,
                                                   const nlohmann::ordered_json& now, const std::string& wording);

}  // namespace haptolith

#pragma once

#include <span>
#include <string_view>

namespace haptolith {

/// The candidate a person most likely meant by `word`: one that begins with it, or the one with the fewest typing
/// errors (at most a third of the word). Empty when none is near.
[[nodiscard]] std::string_view nearestWord(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace haptolith

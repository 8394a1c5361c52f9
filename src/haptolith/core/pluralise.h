#pragma once

#include <fmt/format.h>

#include <concepts>
#include <string>
#include <string_view>

namespace haptolith {

/// "1 trial", "2 trials", and with a separate plural "1 person", "2 people".
[[nodiscard]] std::string pluralise(std::integral auto number, std::string_view one, std::string_view several = {}) {
  return number == 1       ? fmt::format("1 {}", one)
         : several.empty() ? fmt::format("{} {}s", number, one)
                           : fmt::format("{} {}", number, several);
}

}  // namespace haptolith

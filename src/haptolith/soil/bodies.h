#pragma once

#include <span>
#include <string_view>

namespace haptolith {

/// A celestial body, as far as its soil can feel it.
struct Body {
  std::string_view name;
  double gravity_m_s2 = 0;  ///< at the surface
};

/// The six bodies of the paper's user validation (paper, III-A), from the weakest gravity to the strongest.
[[nodiscard]] std::span<const Body> bodies();

/// The body called `name`; upper and lower case are the same.
/// @throws InvalidParameter listing the valid names.
[[nodiscard]] const Body& findBody(std::string_view name);

}  // namespace haptolith

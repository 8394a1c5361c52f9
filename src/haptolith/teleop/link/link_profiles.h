#pragma once

#include <span>
#include <string>
#include <string_view>

#include "haptolith/teleop/link/link_parameters.h"

namespace haptolith {

/// A link in both directions, by its name.
struct LinkProfile {
  std::string name;     ///< "earth-moon"
  std::string what;     ///< its use, one line
  LinkParameters up;    ///< from the operator to the robot
  LinkParameters down;  ///< back

  /// Mean round trip of a small packet, s.
  [[nodiscard]] double roundTrip() const noexcept { return up.delay_s + down.delay_s; }
};

/// Those that the program knows, the quickest first.
[[nodiscard]] std::span<const LinkProfile> linkProfiles();

/// @throws InvalidParameter naming all of them.
[[nodiscard]] const LinkProfile& findLinkProfile(std::string_view name);

}  // namespace haptolith

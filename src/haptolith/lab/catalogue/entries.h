#pragma once

#include <numbers>

#include "haptolith/lab/catalogue/lab_test.h"

namespace haptolith {

inline constexpr double kMm = 1e-3;

[[nodiscard]] constexpr double degrees(double radians) noexcept {
  return radians * 180 / std::numbers::pi;
}
[[nodiscard]] constexpr double radians(double degrees) noexcept {
  return degrees * std::numbers::pi / 180;
}

// Catalogue entries; each call returns a test with separate options.
[[nodiscard]] LabTest settleEntry();
[[nodiscard]] LabTest shearEntry();
[[nodiscard]] LabTest reposeEntry();
[[nodiscard]] LabTest verticalCutEntry();
[[nodiscard]] LabTest plateEntry();
[[nodiscard]] LabTest coneEntry();
[[nodiscard]] LabTest bladeEntry();
[[nodiscard]] LabTest grainSizeEntry();
[[nodiscard]] LabTest rftEntry();
[[nodiscard]] LabTest wheelEntry();
[[nodiscard]] LabTest hopperEntry();
[[nodiscard]] LabTest payloadEntry();
[[nodiscard]] LabTest freeFallEntry();

}  // namespace haptolith

#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "haptolith/lab/catalogue/lab_test.h"
#include "haptolith/lab/lab_bed.h"

namespace haptolith {

inline constexpr double kMm = 1e-3;

[[nodiscard]] constexpr double degrees(double radians) noexcept {
  return radians * 180 / std::numbers::pi;
}
[[nodiscard]] constexpr double radians(double degrees) noexcept {
  return degrees * std::numbers::pi / 180;
}

// Options that set a member of a test's options, which has to live as long; what it holds is the usual value.
[[nodiscard]] LabOption numberOption(std::string key, double& value, std::string help);
[[nodiscard]] LabOption millimetresOption(std::string key, double& length_m, std::string help);
[[nodiscard]] LabOption degreesOption(std::string key, double& angle_rad, std::string help);
[[nodiscard]] LabOption countOption(std::string key, int& value, const Range& valid, std::string help);
/// @param unit  in which the list is given.
[[nodiscard]] LabOption listOption(std::string key, std::vector<double>& values, double unit, std::string help);
[[nodiscard]] LabOption preparationOption(Preparation& preparation);

// The tests; each call gives one with options of its own.
[[nodiscard]] LabTest settleEntry();
[[nodiscard]] LabTest shearEntry();
[[nodiscard]] LabTest reposeEntry();
[[nodiscard]] LabTest cutEntry();
[[nodiscard]] LabTest plateEntry();
[[nodiscard]] LabTest coneEntry();
[[nodiscard]] LabTest bladeEntry();
[[nodiscard]] LabTest grainEntry();
[[nodiscard]] LabTest funnelEntry();
[[nodiscard]] LabTest carryEntry();
[[nodiscard]] LabTest fallEntry();

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <numbers>
#include <span>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"

namespace haptolith {

enum class ToolPartForm : std::uint8_t { kBox, kSphere, kCylinder };

/// A simple solid that a tool is put together of, in the tool's frame.
struct ToolPart {
  ToolPartForm form = ToolPartForm::kBox;
  Vec3 size_m{0.05, 0.04, 0.005};  ///< kBox: edges along its x, y and z
  double diameter_m = 0.02;        ///< kSphere, kCylinder
  double length_m = 0.06;          ///< kCylinder: along its z
  Vec3 at_m = Vec3::Zero();        ///< its middle
  Vec3 turn_rad = Vec3::Zero();    ///< about x first, then y, then z
  int copies = 1;                  ///< evenly round the tool's z, as the grousers of a wheel are

  [[nodiscard]] bool operator==(const ToolPart&) const = default;
};

/// Valid ranges of a ToolPart, along each axis; read by validate() and scene files alike.
struct ToolPartRanges {
  static constexpr Range length_m{0.5e-3, 1};  ///< thinner than a wall of a mesh cannot be felt on both sides
  static constexpr Range count{1, 64};         ///< number of parts, copies too: a short file must not need gigabytes
  static constexpr Range at_m{-1, 1};
  static constexpr Range turn_rad{-2 * std::numbers::pi, 2 * std::numbers::pi};
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const ToolPart& part);

/// The parts as an OBJ file in mm, each closed: the inside of any of them is solid. Round ones have 64 sides,
/// whose corners lie on the surface, so that they are 0.12 % of their radius too small between them.
/// @throws InvalidParameter as validate(), and for too many parts.
[[nodiscard]] std::string drawn(std::span<const ToolPart> parts);

}  // namespace haptolith

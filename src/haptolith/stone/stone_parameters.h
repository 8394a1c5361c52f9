#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"
#include "haptolith/stone/stone_shape.h"

namespace haptolith {

/// Shape of a stone.
enum class StoneForm {
  kRock,     ///< angular, as broken rock is: see angularRock()
  kSphere,   ///< a sphere
  kSpheres,  ///< a union of given spheres, with their own size
};

/// A placed stone.
struct PlacedStone {
  StoneForm form = StoneForm::kRock;
  double size_m = 0.03;                ///< diameter of the sphere of its volume; not for kSpheres
  std::uint64_t seed = 1;              ///< seed of kRock
  std::vector<StoneSphere> spheres{};  ///< spheres of kSpheres, in their own frame
  double x_m = 0, y_m = 0;             ///< its centre, scene frame
  double depth_m = 0;                  ///< depth of its centre below the surface of the soil; negative: above it
  Vec3 turn_rad = Vec3::Zero();        ///< about x first, then y, then z
  bool fixed = false;                  ///< stays where it is, whatever pushes it: bedrock, a post

  [[nodiscard]] bool operator==(const PlacedStone&) const = default;
};

/// Stones in a bed: a number of random sizes at random places, and placed ones.
///
/// The number of random ones larger than D is proportional to D^-exponent between the smallest and the largest, as
/// counts of stones on the Moon do (docs/reference/scene-keys-tool.md).
struct StonesParameters {
  int count = 0;
  StoneForm form = StoneForm::kRock;  ///< not kSpheres
  double smallest_m = 0.02, largest_m = 0.05;
  double exponent = 2.5;
  double shallowest_m = -0.01, deepest_m = 0.03;  ///< depth of their centres below the surface; negative: above it
  std::uint64_t seed = 1;
  bool fixed = false;
  double density_kg_m3 = 2900;  ///< density of all stones, as lunar basalt's grains
  std::vector<PlacedStone> placed{};

  [[nodiscard]] bool any() const noexcept { return count > 0 || !placed.empty(); }
  [[nodiscard]] bool operator==(const StonesParameters&) const = default;
};

/// Valid range of each number alone.
struct StonesRanges {
  static constexpr Range count{0, 1000};
  static constexpr Range exponent{0, 10};
  static constexpr Range depth_m{-10, 100};
  static constexpr Range place_m{-100, 100};
  static constexpr Range turn_rad{-2 * std::numbers::pi, 2 * std::numbers::pi};
  static constexpr Range density_kg_m3{100, 25'000};
  static constexpr Range seed{0, 9e15};  ///< as large as a double and a whole number of TOML can be
  static constexpr Range sphere_place_m{-10, 10};
};

/// No sphere of any of them is larger than this, in m.
[[nodiscard]] double largestSphere(const StonesParameters& stones) noexcept;

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const StonesParameters& stones);

}  // namespace haptolith

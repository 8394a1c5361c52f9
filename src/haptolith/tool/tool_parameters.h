#pragma once

#include <array>
#include <memory>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"
#include "haptolith/tool/joint.h"

namespace haptolith {

struct ToolMesh;

enum class ToolShape {
  kBox,       ///< `size_m`: the shovel; its largest faces look along the tool's z
  kSphere,    ///< `diameter_m`
  kPlate,     ///< a round plate, `diameter_m` across and `thickness_m` high, its axis along the tool's z
  kCone,      ///< `diameter_m` at its base, `cone_angle_rad` between opposite sides, its point down, a shaft above
  kTube,      ///< open at both ends: `diameter_m` in the middle of its wall, `thickness_m` the wall, `length_m` along z
  kCylinder,  ///< closed at both ends: `diameter_m` across and `length_m` long, its axis along the tool's z; a corer's
              ///< outside
  kJaws,  ///< two boxes that face each other across the tool's x, each the `size_m` of a shovel that stands upright,
          ///< and bent to a shell by `jaw_bend_rad`
  kMesh,  ///< `mesh`: any
};

/// All that numbers describe: a mesh is not among them.
inline constexpr std::array kToolShapes{ToolShape::kBox,  ToolShape::kSphere,   ToolShape::kPlate, ToolShape::kCone,
                                        ToolShape::kTube, ToolShape::kCylinder, ToolShape::kJaws};

/// The tool and its contact with macroparticles (paper 21). The tool's origin is its centre, a cone's its point, and of
/// jaws the middle between them. A mesh has it where ToolMeshSource says.
///
///       |     |     z             (     )
///       |     |     |            (       )
///       |     |     o-- x         (     )       bent: the middle of each jaw keeps its length, and bulges outwards
///        <--->                     <--->        opening; the jaws' size_m.z is along x, size_m.y along y, size_m.x
///        along z
struct ToolParameters {
  ToolShape shape = ToolShape::kBox;
  Vec3 size_m{0.05, 0.04, 0.005};                ///< kBox: edges along the tool's x, y, z; kJaws: along z, y, x
  double diameter_m = 0.06;                      ///< kSphere, kPlate, kCone, kTube, kCylinder
  double thickness_m = 0.005;                    ///< kPlate, kTube
  double opening_m = 0.06;                       ///< kJaws: between them, at their ends, when they are wide open
  double jaw_bend_rad = 0;                       ///< kJaws: by which a jaw's upper end is turned against its lower end
  double length_m = 0.06;                        ///< kCone (with its shaft), kTube, kCylinder
  double cone_angle_rad = std::numbers::pi / 6;  ///< kCone; 30 degrees, ASABE S313.3's
  std::shared_ptr<const ToolMesh> mesh{};        ///< kMesh; of toolMesh(), which has each but once
  double stiffness_n_m = 500;                    ///< k_tool
  double damping_factor = 1.4;                   ///< c_tool = damping_factor * dt * k_tool / 2
  double adhesion_ratio = 0.002;                 ///< adhesion reaches this many radii outside the tool (paper 21)

  // With soil whose friction is contact, these two replace the adhesion of (paper 21).
  double friction = 0.36;  ///< soil-tool friction, tan(delta); 20 degrees for polished steel
  double adhesion_n = 0;   ///< largest pull of a contact, and what it adds to the normal force

  double mass_kg = 0;                    ///< that the hand feels; 0: none
  Vec3 centre_of_mass_m = Vec3::Zero();  ///< in the tool's frame

  Joint joint{};  ///< between hand and tool

  [[nodiscard]] bool operator==(const ToolParameters&) const = default;
};

/// Valid ranges; read by validate(), scene files and the page's commands alike.
struct ToolRanges {
  static constexpr Range length_m{1e-5, 10};  ///< edges, diameter, thickness, opening and length
  static constexpr Range cone_angle_rad{0.1, 3};
  static constexpr Range jaw_bend_rad{0, std::numbers::pi};
  static constexpr Range stiffness_n_m{0, 1e7};
  static constexpr Range damping_factor{0, 10};
  static constexpr Range adhesion_ratio{0, 1};
  static constexpr Range friction{0, 10};
  static constexpr Range adhesion_n{0, 1e6};
  static constexpr Range mass_kg{0, 10};
  static constexpr Range centre_of_mass_m{-1, 1};  ///< along each axis
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const ToolParameters& tool);

/// Weight of the tool as a wrench about its origin, scene frame: F = m g, T = (q c) x F. May be called in the tick.
[[nodiscard]] Wrench weightOf(const ToolParameters& tool, const Quat& orientation, const Vec3& gravity_m_s2) noexcept;

}  // namespace haptolith

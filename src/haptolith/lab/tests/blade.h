#pragma once

#include <cstddef>
#include <numbers>
#include <optional>
#include <string_view>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/theory/earthmoving.h"
#include "haptolith/lab/theory/mohr_coulomb.h"
#include "haptolith/lab/theory/wedge.h"

namespace haptolith {

/// A blade, its path and the box it is tested in.
struct BladeOptions {
  double width_m = 0.05;                   ///< w, across the path
  double depth_m = 0.03;                   ///< d, of the lower edge; at least 2 particle diameters, better 6
  double rake_rad = std::numbers::pi / 2;  ///< alpha, as BladeCase::rake_rad; 30 to 120 deg
  double speed_m_s = 0.02;                 ///< v; v^2/(g d) at most 0.1, better 0.02: the equation knows no inertia
  double tool_friction = 0.36;             ///< tan(delta)
  double level_depths = 0.5;               ///< forces are averaged from here, in depths of travel; see bladeTest()
  double travel_depths = 1.5;              ///< to here
  double side_room_depths = 2;             ///< of soil on either side of the blade, in d; 0: none, see bladeTest()
  double ahead_depths = 3;                 ///< of soil ahead of where the blade stops, in d
  double below_depths = 0.8;               ///< of soil under the lower edge, in d
  Preparation preparation = Preparation::kDense;
  DepthFrom depth_from = DepthFrom::kTips;
  double friction_angle_rad = 0.785;  ///< phi of the soil for the equations, as measured by shear
  double cohesion_pa = 0;             ///< c, likewise
  /// What the soil has left once it has sheared, for the equations a second time; none: not known, or the same.
  std::optional<MohrCoulomb> residual = {};
};

/// @throws InvalidParameter where bladeTest() would. Not for the tick.
void validate(const LabConditions& conditions, const BladeOptions& options);

/// What the equations say of a blade, with one strength of the soil.
struct BladeEquations {
  BladeForce earthmoving;                   ///< of earthmovingForce()
  std::optional<BladeForce> upright_wedge;  ///< of uprightWedgeForce(); none of a blade as wide as its box
  std::optional<WedgeForce> wedge;          ///< of wedgeForce(); likewise, and none where it refuses
};

/// The same for soil as it is first broken, and once it has sheared.
struct BladeExpectation {
  BladeEquations undisturbed;
  std::optional<BladeEquations> residual;  ///< none: BladeOptions::residual is not known
};

struct BladeResult {
  double draft_n = 0;     ///< against the movement, mean from level_depths to travel_depths
  double vertical_n = 0;  ///< > 0: the soil pushes the blade down
  double draft_se_n = 0;  ///< standard error of draft_n, from the scatter of ten blocks
  double vertical_se_n = 0;
  double front_draft_n = 0;     ///< of draft_n, what presses on the flat front; see bladeTest()
  double front_vertical_n = 0;  ///< of vertical_n, likewise
  double heap_pa = 0;         ///< q of the wedge with crescents, or else of the plane one, undisturbed; see bladeTest()
  double heap_beside_pa = 0;  ///< of its crescents; 0 without
  BladeExpectation expected;  ///< for `depth_m`, `width_m` and `bulk_density_kg_m3`, and a level surface
  BladeExpectation expected_heaped;  ///< likewise, with the heap's weight
  double depth_m = 0;                ///< below the settled surface: close to the wanted one, not exactly
  double width_m = 0;                ///< of the blade, or of the box when the blade is as wide
  double inertia = 0;                ///< v^2/(g d)
  double bulk_density_kg_m3 = 0;
  std::size_t particles = 0;
  LabTrace trace;  ///< travel, draft and vertical force, each row a mean over 1/50 of the depth
};

/// Draws a blade at constant depth through a settled bed and compares with the fundamental earthmoving equation and
/// with the wedge of McKyes and Ali.
///
/// The soil settles around the blade in place, so nothing is disturbed before it moves. It stands as high as it is deep
/// and half as much above the surface, so no soil flows over it.
///
/// `friction_angle_rad` should be the bed's peak angle: a dense bed fails before it has loosened, and its residual
/// angle gives half the draft (docs/reports/accuracy.md, "Blades").
///
/// Either equation is the balance on the first wedge that breaks out, with a flat surface. The draft climbs while that
/// wedge forms, levels off after about half a depth of travel, and then rises slowly for good, for soil heaps up before
/// the blade. The mean is taken from 0.5 to 1.5 depths. There the heap weighs half as much as the wedge and more:
/// before a wide blade lies all the soil that it has gone through. So each equation is told it, too, as what they call
/// a surcharge:
///
///     q = g (m - m_0) / (w r)
///
/// with m the mass before the front, over the lower edge, as wide as the blade and as far as the equation's wedge
/// reaches on the surface, r = d (cot alpha + cot beta), but no further than ahead_depths, and m_0 the same before the
/// blade has moved. beta is that without a heap. Crescents get what lies on them, over their area: less, the narrower
/// the blade is.
///
/// The earthmoving equation does not know the soil that breaks out to both sides, which adds to the draft of a blade
/// not much wider than deep; the other two do, but not that the box ends side_room_depths beside the blade. With
/// side_room_depths = 0 the blade is as wide as the box, `width_m`, which repeats itself sideways: the earthmoving
/// equation's own plane case.
///
/// The equations know a face and no edge. Grains that meet the lower edge are pressed down and forward as by a bar as
/// thick as the blade and a grain, which costs little where the blade is upright, and as much as the wedge where it is
/// at 45 degrees and a grain is a fifth of the depth. So what presses on the front, where the contact's normal is that
/// of the front within 18 degrees, is told apart: that is what equations are about, and draft_n is what a hand feels.
/// @throws InvalidParameter outside the ranges above; Failure as LabBed::run(). Not for the tick.
[[nodiscard]] BladeResult bladeTest(const LabConditions& conditions, const BladeOptions& options = {});

/// Strength of soil under the stresses before a blade.
struct BladeStrength {
  MohrCoulomb undisturbed;              ///< when it first fails, which the equations describe: dense soil's peak
  std::optional<MohrCoulomb> residual;  ///< when it has sheared; none of loose soil, which has no other strength
};

/// Measured by shearing under 200 to 800 Pa. @throws as shearTest(). Not for the tick.
[[nodiscard]] BladeStrength strengthBeforeBlade(const LabConditions& conditions, Preparation preparation);

/// Draws draft and vertical force against travel, with the equations', with and without the heap, into an .svg or .png
/// file. @throws as Figure.
void drawBlade(const OutputFile& file, const BladeResult& result, std::string_view title);

}  // namespace haptolith

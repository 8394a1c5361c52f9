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

/// Blade, its path and the box of the test.
struct BladeOptions {
  double width_m = 0.05;                   ///< w, across the path
  double depth_m = 0.03;                   ///< d, depth of the lower edge; at least 2 particle diameters, better 6
  double rake_rad = std::numbers::pi / 2;  ///< alpha, as BladeCase::rake_rad; 30 to 120 deg
  /// v; v^2/(g d) at most 0.1, better 0.02, because the equation neglects inertia; empty: it is 0.008.
  std::optional<double> speed_m_s;
  double tool_friction = 0.36;  ///< tan(delta)
  double level_depths = 0.5;    ///< begin of the average, in depths of travel; see bladeTest()
  double travel_depths = 1.5;   ///< its end, in depths of travel
  double side_room_depths = 2;  ///< soil on either side of the blade, in d; 0: none, see bladeTest()
  double ahead_depths = 3;      ///< soil ahead of the blade's final position, in d
  double below_depths = 0.8;    ///< soil under the lower edge, in d
  Preparation preparation = Preparation::kDense;
  DepthFrom depth_from = DepthFrom::kTips;
  double friction_angle_rad = 0.785;  ///< phi for the equations, as found by a shear test
  double cohesion_pa = 0;             ///< c for the equations, as found by a shear test
  /// Residual strength, for a second evaluation of the equations; empty: unknown, or equal.
  std::optional<MohrCoulomb> residual = {};
};

/// @throws InvalidParameter as bladeTest(). Not for the tick.
void validate(const LabConditions& conditions, const BladeOptions& options);

/// Blade forces by the equations, with one strength of the soil.
struct BladeEquations {
  BladeForce earthmoving;                   ///< result of earthmovingForce()
  std::optional<BladeForce> upright_wedge;  ///< result of uprightWedgeForce(); empty for a blade as wide as its box
  std::optional<WedgeForce> wedge;          ///< result of wedgeForce(); also empty outside its range
};

/// Blade forces for undisturbed soil, and for sheared soil.
struct BladeExpectation {
  BladeEquations undisturbed;
  std::optional<BladeEquations> residual;  ///< empty: BladeOptions::residual is unknown
};

struct BladeResult {
  double draft_n = 0;     ///< force against the movement, mean from level_depths to travel_depths
  double vertical_n = 0;  ///< > 0: the soil pushes the blade down
  double draft_se_n = 0;  ///< standard error of draft_n, from the scatter of ten blocks
  double vertical_se_n = 0;
  double front_draft_n = 0;     ///< part of draft_n on the flat front; see bladeTest()
  double front_vertical_n = 0;  ///< part of vertical_n on the flat front
  double heap_pa = 0;  ///< q on the wedge with crescents, or else on the plane one, peak strength; see bladeTest()
  double heap_beside_pa = 0;         ///< q on its crescents; 0 without crescents
  BladeExpectation expected;         ///< forces for `depth_m`, `width_m` and `bulk_density_kg_m3`, with a level surface
  BladeExpectation expected_heaped;  ///< forces with the surcharge
  double depth_m = 0;                ///< depth below the settled surface; close to the wanted one, not exactly equal
  double width_m = 0;                ///< width of the blade, or of the box if the blade is as wide
  double inertia = 0;                ///< v^2/(g d)
  double bulk_density_kg_m3 = 0;
  std::size_t particles = 0;
  LabTrace trace;  ///< travel, draft and vertical force; each row is a mean over 1/50 of the depth
};

/// Draws a blade at constant depth through a settled bed and compares with the fundamental earthmoving equation and
/// with the wedge of McKyes and Ali.
///
/// The soil settles around the blade in place, so it is undisturbed before the blade moves. The blade's height above
/// the surface is 1.5 times its depth, so no soil flows over it.
///
/// `friction_angle_rad` should be the bed's peak angle: a dense bed fails before it has loosened, and its residual
/// angle gives half the draft (docs/reports/accuracy.md, "Blades").
///
/// Both equations are the balance on the first wedge that breaks out, with a flat surface. The draft rises while that
/// wedge forms and levels off after about half a depth of travel. Then it rises slowly and steadily, because soil
/// accumulates in front of the blade. The mean is taken from 0.5 to 1.5 depths. There the accumulated soil weighs at
/// least half as much as the wedge, because a wide blade pushes all the soil on its path. So each equation gets it as a
/// surcharge:
///
///     q = g (m - m_0) / (w r)
///
/// Mass m is the soil in front of the blade, above the lower edge, over the blade's width. It extends as far as the
/// equation's wedge on the surface, r = d (cot alpha + cot beta), but at most to ahead_depths; m_0 is m before the
/// blade has moved. beta is that without a surcharge. Crescents get the weight on them over their area: the narrower
/// the blade, the smaller it is.
///
/// The earthmoving equation neglects the soil that breaks out to both sides, which adds to the draft of a blade not
/// much wider than deep. The other two include it, but not the walls of the box at side_room_depths from the blade.
/// With side_room_depths = 0 the blade is as wide as the box, `width_m`, which is periodic sideways: the plane case of
/// the earthmoving equation.
///
/// The equations describe a face without an edge. Particles at the lower edge are pressed down and forward as by a bar
/// as thick as the blade and a particle. This adds little for an upright blade. It adds as much as the wedge for a
/// blade at 45 degrees and a particle size of a fifth of the depth. So the force on the front is reported separately,
/// from contacts with a normal within 18 degrees of the front's. The equations describe that force; draft_n is the
/// total.
/// @throws InvalidParameter outside the ranges above; Failure as LabBed::run(). Not for the tick.
[[nodiscard]] BladeResult bladeTest(const LabConditions& conditions, const BladeOptions& options = {});

/// Strength of soil under the stresses in front of a blade.
struct BladeStrength {
  MohrCoulomb undisturbed;              ///< strength at first failure, as in the equations; the peak of dense soil
  std::optional<MohrCoulomb> residual;  ///< strength after shearing; empty for loose soil, which has no peak
};

/// Simulates shear tests under 200 to 800 Pa. @throws as shearTest(). Not for the tick.
[[nodiscard]] BladeStrength strengthBeforeBlade(const LabConditions& conditions, Preparation preparation);

/// Draws draft and vertical force against travel into an .svg or .png file, with those of the equations, with and
/// without surcharge. @throws as Figure.
void drawBlade(const OutputFile& file, const BladeResult& result, std::string_view title);

}  // namespace haptolith

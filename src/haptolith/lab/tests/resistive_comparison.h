#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/tests/shear.h"
#include "haptolith/lab/theory/resistive_force.h"

namespace haptolith {

/// Tools pushed into the bed and drawn through it for the comparison with the theory.
struct ResistiveOptions {
  double diameter_m = 0.05;        ///< D of plate, sphere and cone; at least 8 particle radii
  double max_sinkage_m = 0.02;     ///< max. sinkage of plate, sphere and cone (lowest point); above 0 to D/2
  double push_speed_m_s = 0.03;    ///< v^2/(g D) should be far below 1
  double bed_width_diameters = 3;  ///< width of the box, in D: space for the soil next to the tool; at least 2
  double blade_width_m = 0.05;     ///< width across the path
  double blade_depth_m = 0.03;     ///< depth of an upright blade's lower edge
  double blade_speed_m_s = 0.03;   ///< v^2/(g d) at most 0.1
  double size_factor = 1.5;        ///< scale of the larger plate, its sinkage and its box; above 1 to 4
  bool scaling = true;             ///< whether the plate test is repeated for each scaling law
  Preparation preparation = Preparation::kDense;
  DepthFrom depth_from = DepthFrom::kTips;
  /// Shear tests for the inputs of the theory; without cohesion.
  ShearOptions shear{.normal_stresses_pa = {200, 400, 800}};
  double friction_angle_rad = 0;  ///< angle for the theory; 0: the residual one, from simulated shear tests
};

/// Force on a pushed tool in the bed and by the theory.
struct ResistivePoint {
  double depth_m = 0;  ///< depth of its lowest point
  double bed_n = 0;    ///< upward force
  double theory_n = 0;
};

struct ResistivePush {
  std::string name;
  std::vector<ResistivePoint> curve;
  double bed_n = 0;  ///< mean force over the deeper two thirds of the curve
  double theory_n = 0;
  double bulk_density_kg_m3 = 0;  ///< density of the bed before the push
};

/// Change of the plate's force with one parameter: force ~ parameter^exponent.
struct ResistiveScaling {
  std::string name;
  double factor = 0;          ///< factor of the parameter
  double force_factor = 0;    ///< factor of the bed's force
  double density_factor = 0;  ///< factor of the bed's density, because heavier soil settles denser
  double exponent = 0;
  double theory_exponent = 0;
};

struct ResistiveResult {
  ResistiveSoil soil;  ///< input of the theory, surface at 0
  double xi_n_m3 = 0;
  double peak_angle_rad = 0;          ///< from simulated shear tests, for the earthmoving equation
  std::vector<ResistivePush> pushes;  ///< plate, sphere, cone, and a wheel that does not rotate
  double blade_depth_m = 0;           ///< depth below the settled surface
  double draft_n = 0, draft_se_n = 0, theory_draft_n = 0, earthmoving_draft_n = 0;
  double vertical_n = 0, theory_vertical_n = 0;  ///< > 0: the soil pushes the blade down
  std::vector<ResistiveScaling> scalings;
  LabTrace trace;  ///< trace of the plate: sinkage_m, force_n, theory_n
};

/// Compares tools in the simulated bed with three-dimensional resistive force theory, without tuning. The inputs of the
/// theory are density and friction of the soil in the residual state, from shearTest().
///
/// Cohesion between the particles is removed because the theory has none.
/// @throws InvalidParameter outside the ranges above; Failure as LabBed::run(). Not for the tick.
[[nodiscard]] ResistiveResult resistiveComparison(const LabConditions& conditions,
                                                  const ResistiveOptions& options = {});

/// Draws forces over depth into an .svg or .png file. @throws as Figure.
void drawResistive(const OutputFile& file, const ResistiveResult& result, std::string_view title);

}  // namespace haptolith

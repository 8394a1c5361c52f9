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

/// What is pushed into the bed and drawn through it beside the theory.
struct ResistiveOptions {
  double diameter_m = 0.05;       ///< D of plate, sphere and cone; at least 8 particle radii
  double max_sinkage_m = 0.02;    ///< of the plate, and of the lowest point of sphere and cone; above 0 to D/2
  double push_speed_m_s = 0.03;   ///< v^2/(g D) should be far below 1
  double blade_width_m = 0.05;    ///< across the path
  double blade_depth_m = 0.03;    ///< of an upright blade's lower edge
  double blade_speed_m_s = 0.03;  ///< v^2/(g d) at most 0.1
  double size_factor = 1.5;       ///< of the larger plate, its sinkage and its box; above 1 to 4
  bool scaling = true;            ///< whether the plate is pushed once more for each law of scaling
  Preparation preparation = Preparation::kDense;
  DepthFrom depth_from = DepthFrom::kTips;
  /// How the soil is sheared that the theory is told of; without its own cohesion.
  ShearOptions shear{.normal_stresses_pa = {200, 400, 800}};
  double friction_angle_rad = 0;  ///< for the theory; 0: the residual one, measured by shearing the soil
};

/// Force on a pushed tool in the bed and by the theory.
struct ResistivePoint {
  double depth_m = 0;  ///< of its lowest point
  double bed_n = 0;    ///< upwards
  double theory_n = 0;
};

struct ResistivePush {
  std::string name;
  std::vector<ResistivePoint> curve;
  double bed_n = 0;  ///< mean over the deeper two thirds of the curve
  double theory_n = 0;
  double bulk_density_kg_m3 = 0;  ///< of the bed, before the push
};

/// What became of the plate's force when one thing changed: force ~ thing^exponent.
struct ResistiveScaling {
  std::string name;
  double factor = 0;          ///< by which it changed
  double force_factor = 0;    ///< by which the bed's force did
  double density_factor = 0;  ///< by which the bed's own density did, for soil settles denser where it weighs more
  double exponent = 0;
  double theory_exponent = 0;
};

struct ResistiveResult {
  ResistiveSoil soil;  ///< as the theory was told, surface at 0
  double xi_n_m3 = 0;
  double peak_angle_rad = 0;          ///< measured, for the earthmoving equation
  std::vector<ResistivePush> pushes;  ///< plate, sphere, cone, and a wheel that does not turn
  double blade_depth_m = 0;           ///< below the settled surface
  double draft_n = 0, draft_se_n = 0, theory_draft_n = 0, earthmoving_draft_n = 0;
  double vertical_n = 0, theory_vertical_n = 0;  ///< > 0: the soil pushes the blade down
  std::vector<ResistiveScaling> scalings;
  LabTrace trace;  ///< of the plate: sinkage_m, force_n, theory_n
};

/// Tools in our bed beside three-dimensional resistive force theory, in the same soil and with nothing tuned: the
/// theory gets the density and friction of the soil once it has been sheared for long, as shearTest() measures them.
///
/// Cohesion between the particles is taken away, for the theory has none.
/// @throws InvalidParameter outside the ranges above; Failure as LabBed::run(). Not for the tick.
[[nodiscard]] ResistiveResult resistiveComparison(const LabConditions& conditions,
                                                  const ResistiveOptions& options = {});

/// Forces over depth into an .svg or .png file. @throws as Figure.
void drawResistive(const OutputFile& file, const ResistiveResult& result, std::string_view title);

}  // namespace haptolith

#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/apparatus/wheel_rig.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/theory/resistive_force.h"
#include "haptolith/lab/theory/rigid_wheel.h"

namespace haptolith {

/// Setting of a wheel.
struct WheelSetting {
  double slip = 0;            ///< s; driven: 1 - v / (r omega), braked: r omega / v - 1; -1 to 0.95
  double slip_angle_rad = 0;  ///< angle of the wheel's plane to the left of the path; -90 to 90 deg
  double load_n = 0;          ///< vertical; unused with a constant sinkage
};

/// Plate numbers of the soil, for the theory of Bekker and Wong.
struct PlateNumbers {
  double modulus = 0;   ///< k of p = k z^n, in Pa/m^n; 0: not compared
  double exponent = 1;  ///< n
};

/// Wheel, its settings and the box of the test.
struct WheelOptions {
  WheelShape wheel;
  std::vector<WheelSetting> settings;  ///< one or more
  double sinkage_m = 0;                ///< constant sinkage; 0: constant load
  double mass_kg = 0;                  ///< that moves on the vertical slide; 0: the load over gravity
  double travel_m_s = 0.08;            ///< speed, reduced where the rim would exceed max_rim_m_s
  double max_rim_m_s = 0.2;            ///< the smaller r omega^2 / g, the slower may be called quasi-static
  double travel_m = 0.2;               ///< distance
  double steady_from = 0.6;            ///< fraction of the travel at which the averages begin; 0.1 to 0.9
  double bed_depth_m = 0;              ///< as filled; 0: the diameter
  double side_room_m = 0;              ///< soil on either side of the wheel; 0: 0.75 diameters
  Preparation preparation = Preparation::kDense;
  DepthFrom depth_from = DepthFrom::kSurface;
  double friction_angle_rad = 0;  ///< angle for the theories; 0: not compared
  PlateNumbers plate;
};

/// Result of one setting; forces as WheelReading.
struct WheelPoint {
  WheelSetting setting;
  double travel_m_s = 0, rim_m_s = 0;
  WheelMean drawbar_n, side_n, vertical_n, torque_nm, sinkage_m;  ///< after steady_from
  double sinkage_change_m = 0;        ///< mean sinkage of the second half of the averages minus that of the first
  bool is_steady = false;             ///< whether that is at most 0.03 r
  std::optional<WheelForces> bekker;  ///< without a slip angle and grousers
  struct Resistive {
    double sinkage_m = 0, vertical_n = 0, drawbar_n = 0, side_n = 0, torque_nm = 0;
  };
  std::optional<Resistive> resistive;  ///< 3D resistive force theory
};

/// Returns the forces by 3D resistive force theory (theory/resistive_force.h) at the sinkage of the load, or at the
/// constant one. Each element has the velocity of the moving surface. With grousers it is the mean over a pitch. Empty
/// for a load that the wheel does not carry at any sinkage up to its diameter.
/// @param tool  wheelTool(). @param soil  with its surface at 0. @throws as resistiveForce(). Not for the tick.
[[nodiscard]] std::optional<WheelPoint::Resistive> resistiveWheel(const WheelOptions& options,
                                                                  const ToolParameters& tool,
                                                                  const WheelSetting& setting,
                                                                  const ResistiveSoil& soil);

struct WheelResult {
  std::vector<WheelPoint> points;  ///< in the order of the settings
  double radius_m = 0;
  double bulk_density_kg_m3 = 0;
  double bed_depth_m = 0;
  std::size_t particles = 0;
  LabTrace trace;
};

/// @throws InvalidParameter as wheelTest(). Not for the tick.
void validate(const LabConditions& conditions, const WheelOptions& options);

/// Lets a wheel travel through the same bed once for each setting, as a single-wheel rig. The hub is guided along x and
/// free or held vertically; a motor holds the speed of the rim. Each travel begins with the bed as it has settled.
/// Averages are taken after steady_from of the travel; their SD is that of means over 1 mm.
///
/// The theories get the bed's density and `friction_angle_rad`.
/// @throws InvalidParameter outside the ranges above; Failure as runWheel(). Not for the tick.
[[nodiscard]] WheelResult wheelTest(const LabConditions& conditions, const WheelOptions& options);

/// Measured wheel.
struct MeasuredWheel {
  WheelSetting setting;
  double drawbar_n = 0, side_n = 0, sinkage_m = 0;
};

/// Difference between a wheel and its measurements. Forces are over the load, errors are absolute.
struct WheelComparison {
  std::size_t points = 0;
  double drawbar_error = 0, side_error = 0;  ///< medians
  std::size_t slipping = 0;                  ///< number of points with |slip| above 0.21
  double drawbar_sign = 0, side_sign = 0;    ///< fraction of those with the measured sign
  double sinkage_within = 0;                 ///< fraction of the points with a sinkage within 35 %
};

/// Forces of a wheel by a simulation or a theory.
struct WheelEstimate {
  double drawbar_n = 0, side_n = 0, sinkage_m = 0;
};

/// @param estimates  one per measurement.
[[nodiscard]] WheelComparison compareWheel(const std::vector<MeasuredWheel>& measured,
                                           const std::vector<WheelEstimate>& estimates);

/// Draws drawbar pull, side force, torque and sinkage over slip into an .svg or .png file, one colour per slip angle.
/// @throws as Figure.
void drawWheel(const OutputFile& file, const WheelResult& result, std::string_view title,
               const std::vector<MeasuredWheel>& measured = {});

}  // namespace haptolith

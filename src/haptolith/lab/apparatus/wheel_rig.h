#pragma once

#include <optional>
#include <span>
#include <vector>

#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Wheel that turns about its axle, the z axis of the tool.
struct WheelShape {
  double diameter_m = 0.116;  ///< at the base of the grousers; at least 8 particle radii
  double width_m = 0.05;      ///< along the axle
  int grousers = 0;           ///< number of bars across the rim; 0 to 60
  double grouser_height_m = 0.005;
  double grouser_thickness_m = 0.002;
  double friction = 0.36;  ///< tan(delta) between wheel and soil
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const WheelShape& wheel, const SoilParameters& soil);

/// Returns the wheel as a tool with a joint about its axle: a cylinder, or with grousers a mesh of parts.
/// @throws InvalidParameter as validate().
[[nodiscard]] ToolParameters wheelTool(const WheelShape& wheel, const SoilParameters& soil);

/// Carriage with a wheel, or another tool with a joint. It travels along x. The hub does not turn.
struct WheelRun {
  ToolParameters tool;        ///< joint: the axle, right-handed about it forwards
  double radius_m = 0;        ///< from the axle to the rim: the zero of sinkage, and the speed of the rim
  double below_m = 0;         ///< from the axle to the lowest point, at most
  double slip_angle_rad = 0;  ///< angle of the wheel's plane to the left of the path; -90 to 90 deg
  double travel_m_s = 0;      ///< speed; above 0
  double travel_m = 0;        ///< distance
  double drive = 0;  ///< speed of the joint in rad/s, or its torque in N m, from the beginning of the travel on
  std::optional<double> load_n;  ///< vertical load; the slide is free
  double mass_kg = 0;            ///< that moves on the slide
  double sinkage_m = 0;          ///< without a load: held, after the first quarter of the travel
  double surface_m = 0;          ///< height of the level surface
  double start_x_m = 0;          ///< position of the axle at the start
  double sample_m = 1e-3;        ///< travel over which a reading is averaged
};

/// Mean over WheelRun::sample_m. Forces and torques of the soil on the wheel.
struct WheelReading {
  double travel_m = 0;
  double drawbar_n = 0;     ///< in the wheel's plane, forwards
  double side_n = 0;        ///< along the axle, to the left of the wheel
  double vertical_n = 0;    ///< upwards
  double torque_nm = 0;     ///< torque of the motor, > 0 driving
  double sinkage_m = 0;     ///< depth of the rim's lowest point below the surface
  double rim_m_s = 0;       ///< speed of the rim
  double along_path_n = 0;  ///< force along the path, forwards
};

/// Lowers the wheel onto the soil and lets it travel.
///
/// A constant load grows from 0 within 0.3 s, while the wheel is at rest, so that it does not fall in. The slide is a
/// mass m: m dw/dt = F_z - load, semi-implicit Euler in each step. The load includes the weight of the slide.
/// @param bed  settled, with the tool of `run`.
/// @throws InvalidParameter for a tool without a joint, and outside the ranges above; Failure as LabBed::run(), and
/// when the wheel sinks to the floor. Not for the tick.
[[nodiscard]] std::vector<WheelReading> runWheel(LabBed& bed, const WheelRun& run);

/// Mean and standard deviation of one quantity over the readings.
struct WheelMean {
  double value = 0, sd = 0;
};
[[nodiscard]] WheelMean meanOf(std::span<const WheelReading> readings, double WheelReading::*quantity);

}  // namespace haptolith

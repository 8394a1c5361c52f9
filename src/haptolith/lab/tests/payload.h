#pragma once

#include <string_view>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Valid ranges.
struct PayloadRanges {
  static constexpr Range particles{20, 1000};
};

struct PayloadOptions {
  int particles = 200;       ///< number of particles dropped on the shovel; part of them falls off
  double shovel_radii = 20;  ///< edge length of the square shovel in mean particle radii, 8 to 60
  double speed_m_s = 0.1;    ///< sideways speed, 0.01 to 0.2
  double shake_g = 0.2;      ///< max. acceleration of the vertical shaking, over g, 0.01 to 0.8
  /// Frequency of shaking, 0.2 to 20. Loose soil is a soft spring: a high pile has a natural frequency near 5 Hz. Well
  /// below that frequency it moves as one body.
  double shake_hz = 0.5;
  ToolParameters shovel{};  ///< contact parameters; the test sets shape and size
};

struct PayloadResult {
  double weight_ratio = 0;  ///< force on the shovel at rest over the weight of the carried soil
  double drag_ratio = 0;    ///< mean force against a steady sideways movement over that weight
  double follow_ratio = 0;  ///< sideways displacement of the soil over the shovel's
  double shake_ratio = 0;   ///< change of force over mass times acceleration, during shaking
  double carried_kg = 0;    ///< mass of the carried soil at rest
  double left_kg = 0;       ///< mass of the carried soil at the end
  LabTrace trace;  ///< time_s, felt_down_n, felt_back_n, weight_n, speed_m_s, acceleration_up_m_s2; means over 5 ms
};

/// Simulates a payload: a heap of soil on a level shovel in empty space. Soil is dropped on the shovel inside a virtual
/// tube; the spilled part is on the floor far below. Then the shovel is at rest, moves sideways from a gentle start,
/// stops, and is shaken up and down.
///
/// By Newton's laws the force on the shovel is the soil's weight plus mass times acceleration, without drag in a steady
/// movement, and the soil follows the shovel. A model that brakes particles against space makes the soil hang instead,
/// even without the shovel.
/// @throws InvalidParameter for values out of range, and without gravity; Failure as LabBed::run(), and when no soil
/// stays on the shovel.
[[nodiscard]] PayloadResult payloadTest(const LabConditions& conditions, const PayloadOptions& options = {});

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const PayloadOptions& options);

/// Draws force against time, and the weight. @throws as Figure.
void drawPayload(const OutputFile& path, const PayloadResult& result, std::string_view title);

}  // namespace haptolith

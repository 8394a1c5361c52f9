#pragma once

#include <string_view>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// What is valid.
struct CarryRanges {
  static constexpr Range particles{20, 1000};
};

struct CarryOptions {
  int particles = 200;       ///< dropped on the shovel; some fall off
  double shovel_radii = 20;  ///< edge of the square shovel in mean particle radii, 8 to 60
  double speed_m_s = 0.1;    ///< sideways, 0.01 to 0.2
  double shake_g = 0.2;      ///< largest acceleration while it is shaken up and down, over g, 0.01 to 0.8
  /// How fast, 0.2 to 20. Loose soil is a soft spring: piled up high it has a frequency of its own near 5 Hz,
  /// and well below that it goes up and down as one body.
  double shake_hz = 0.5;
  ToolParameters shovel{};  ///< its contact; shape and size are set by the test
};

struct CarryResult {
  double weight_ratio = 0;  ///< felt while it stands still, over the weight of the soil that lies on it
  double drag_ratio = 0;    ///< mean force against a steady sideways movement, over that weight
  double follow_ratio = 0;  ///< way of the soil while the shovel moves sideways, over the shovel's
  double shake_ratio = 0;   ///< felt change of weight over mass times acceleration, while it is shaken
  double carried_kg = 0;    ///< soil that lies on the shovel when it stands still
  double left_kg = 0;       ///< and what is left of it at the end
  LabTrace trace;  ///< time_s, felt_down_n, felt_back_n, weight_n, speed_m_s, acceleration_up_m_s2; means over 5 ms
};

/// A heap of soil on a level shovel in empty space: what a hand feels that carries soil. Soil is dropped on the shovel
/// inside an imaginary tube, and what does not stay lies on the floor far below. Then the shovel stands still, is moved
/// sideways from a gentle start, stops, and is shaken up and down.
///
/// By Newton's laws a hand feels the soil's weight, nothing against a steady movement, and mass times acceleration; and
/// soil goes where the shovel goes. Soil that is braked against space hangs in it instead, also when the shovel has
/// gone.
/// @throws InvalidParameter for nonsense, and without gravity; Failure as LabBed::run(), and when nothing stays.
[[nodiscard]] CarryResult carryTest(const LabConditions& conditions, const CarryOptions& options = {});

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const CarryOptions& options);

/// Force against time, and the weight. @throws as Figure.
void drawCarry(const OutputFile& path, const CarryResult& result, std::string_view title);

}  // namespace haptolith

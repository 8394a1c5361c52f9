#pragma once

#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/haptics/coupling.h"
#include "haptolith/haptics/haptic_loop.h"

namespace haptolith {

/// How a simulated hand holds the handle of a device that weighs 0.25 kg.
enum class Grip {
  kStiff,   ///< 800 N/m, 10 N s/m, 0.5 kg of hand
  kLoose,   ///< 100 N/m, 3 N s/m, 0.3 kg of hand
  kNone,    ///< nobody: the handle rests on the soil with 2 N
  kLetsGo,  ///< stiff, until it opens suddenly 15 mm deep in the soil; the handle's weight is balanced
};

[[nodiscard]] const char* text(Grip grip) noexcept;

/// A hand, a device and a way to join it to the soil. Everything but the soil.
struct StabilityCase {
  Grip grip = Grip::kStiff;
  double damping_n_s_m = 0;  ///< the device's own
  int delay_ticks = 0;       ///< from write() to the force
  CouplingKind coupling = CouplingKind::kDirect;
  bool passivity = true;
};

struct StabilityResult {
  /// The most that the handle has been given since the first tick, less what it gave, in J. Soil that nobody has
  /// pressed has nothing to give: it should not be above zero.
  double injected_j = 0;
  /// How much of that came back within the last two seconds, in J: what a vibration brings, swing by swing.
  double returned_j = 0;
  /// How far the handle moves to and fro above 6 Hz in the last two seconds, when the hand is still, in m.
  double vibration_m = 0;
  double damped_share = 0;  ///< of all ticks in which the controller added damping
  LoopEnd end = LoopEnd::kRunning;
};

/// Presses the tool 15 mm into the soil within 1 s, stirs for 2 s at 0.5 Hz, and holds still for 3 s. The device tells
/// positions in steps of 0.02 mm and a low-pass of their differences, and shows forces in steps of 0.01 N, 12 N at
/// most and 4000 N/s at most.
/// @param bed  at rest, as Scene takes it.
/// @throws InvalidParameter as Scene and HapticLoop.
[[nodiscard]] StabilityResult measureStability(const BedParameters& bed, const std::vector<Vec3>& centres_m,
                                               const StabilityCase& parameters);

/// Where the particles of this bed are when it has come to rest.
[[nodiscard]] std::vector<Vec3> settled(const BedParameters& bed);

}  // namespace haptolith

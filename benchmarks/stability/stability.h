#pragma once

#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/haptics/coupling.h"
#include "haptolith/haptics/loop/haptic_loop.h"

namespace haptolith {

/// When a hand opens: never, a millimetre above the soil, or 15 mm deep in it when it would hold still.
enum class Opens { kNever, kAtSoil, kWhenStill };

/// How a simulated hand holds the handle of a device.
struct HoldingHand {
  const char* name = "";
  double stiffness_n_m = 0, damping_n_s_m = 0;
  double mass_kg = 0;   ///< moves with the handle
  double weight_n = 0;  ///< of a released handle; 0: balanced
  Opens opens = Opens::kNever;
};

/// Hands that a person could have, and one that is away: the handle rests on the soil with 2 N.
inline constexpr HoldingHand kStiffHand{"stiff", 800, 10, 0.5, 0};
inline constexpr HoldingHand kLooseHand{"loose", 100, 3, 0.3, 0};
inline constexpr HoldingHand kNoHand{"none", 0, 0, 0, 2};
inline constexpr HoldingHand kOpeningHand{"releases", 800, 10, 0.5, 0, Opens::kWhenStill};
/// Hands without mass are harder to keep still at a light handle.
inline constexpr HoldingHand kLightHands[]{
    {"stiff, light", 1500, 20},
    {"firm, light", 800, 10},
    {"medium, light", 300, 5},
    {"loose, light", 50, 1},
};

/// Hands that release the handle.
inline constexpr HoldingHand kReleasedHands[]{
    {"releases", 300, 5, 0, 0, Opens::kWhenStill},
    {"releases", 300, 5, 0, 2, Opens::kWhenStill},
    {"drops", 300, 5, 0, 2, Opens::kAtSoil},
    {"drops from 20 mm", 0, 0, 0, 2},
};

/// A hand, a device and a way to join it to the soil. Everything but the soil.
struct StabilityCase {
  HoldingHand hand = kStiffHand;
  double handle_kg = 0.25;
  double damping_n_s_m = 0;    ///< the device's own
  int delay_ticks = 0;         ///< from write() to the force
  int declared_ticks = -1;     ///< what the device declares of that; -1: nothing
  double step_m = 2e-5;        ///< of positions
  double noise_m = 0;          ///< of positions, to either side
  double resolution_m = 2e-5;  ///< what the device declares of both
  CouplingKind coupling = CouplingKind::kDirect;
  ArmParameters spring = CouplingParameters().spring;  ///< of a virtual coupling
  bool passivity = true;
};

struct StabilityResult {
  /// The most that the handle has been given since the first tick, less what it gave, in J. Soil that nobody has
  /// pressed has nothing to give: it should not be above zero.
  double injected_j = 0;
  double released_n = 0;       ///< force on the handle when the hand opened
  double after_release_j = 0;  ///< the same since the hand opened: what pressed springs held comes back, too
  /// How much of that came back within the last two seconds, in J: what a vibration brings, swing by swing.
  double returned_j = 0;
  /// How far the handle moves to and fro above 6 Hz in the last two seconds, when the hand is still, in m.
  double vibration_m = 0;
  double vibration_before_m = 0;  ///< the same in the second before
  double damped_share = 0;        ///< of all ticks in which the controller changed the force
  double held_n = 0;              ///< mean force in the last second
  double felt_sd_n = 0;           ///< and its standard deviation
  double softest = 1;             ///< the smallest share of the force that was left
  LoopEnd end = LoopEnd::kRunning;
};

/// Presses the tool 15 mm into the soil within 1 s, stirs for 2 s at 0.5 Hz, and holds still for 3 s. The device tells
/// positions in steps and a low-pass of their differences, and shows forces in steps of 0.01 N, 12 N at most and
/// 4000 N/s at most.
/// @param lying  of settled(bed).
/// @throws InvalidParameter as Scene and HapticLoop.
[[nodiscard]] StabilityResult measureStability(const BedParameters& bed, const LyingSoil& lying,
                                               const StabilityCase& parameters, const ToolParameters& tool = {});

/// Soil of this bed when it has come to rest.
[[nodiscard]] LyingSoil settled(const BedParameters& bed);

}  // namespace haptolith

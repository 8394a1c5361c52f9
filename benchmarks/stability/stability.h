#pragma once

#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/haptics/coupling.h"
#include "haptolith/haptics/loop/haptic_loop.h"

namespace haptolith {

/// Time at which a hand opens: never, 1 mm above the soil, or 15 mm deep in it at the begin of the still hold.
enum class Opens { kNever, kAtSoil, kWhenStill };

/// Grip of a simulated hand on a device's handle.
struct HoldingHand {
  const char* name = "";
  double stiffness_n_m = 0, damping_n_s_m = 0;
  double mass_kg = 0;   ///< moves with the handle
  double weight_n = 0;  ///< weight of a released handle; 0: balanced
  Opens opens = Opens::kNever;
};

// Realistic hands, and one without a hand: the handle rests on the soil with 2 N.
inline constexpr HoldingHand kStiffHand{"stiff", 800, 10, 0.5, 0};
inline constexpr HoldingHand kLooseHand{"loose", 100, 3, 0.3, 0};
inline constexpr HoldingHand kNoHand{"none", 0, 0, 0, 2};
inline constexpr HoldingHand kOpeningHand{"releases", 800, 10, 0.5, 0, Opens::kWhenStill};
/// Hands without mass, which are harder to stabilise with a light handle.
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

/// Hand, device and coupling to the soil; everything except the soil.
struct StabilityCase {
  HoldingHand hand = kStiffHand;
  double handle_kg = 0.25;
  double damping_n_s_m = 0;    ///< the device's damping
  int delay_ticks = 0;         ///< delay from write() to the force
  int declared_ticks = -1;     ///< delay that the device declares; -1: none
  double step_m = 2e-5;        ///< resolution of positions
  double noise_m = 0;          ///< noise amplitude of positions, to either side
  double resolution_m = 2e-5;  ///< resolution that the device declares for both
  CouplingKind coupling = CouplingKind::kDirect;
  ArmParameters spring = CouplingParameters().spring;  ///< spring of a virtual coupling
  bool passivity = true;
};

struct StabilityResult {
  /// Maximum net energy transferred to the handle since the first tick, in J. Undisturbed soil stores no energy, so it
  /// should not be above zero.
  double injected_j = 0;
  double released_n = 0;       ///< force on the handle at the release
  double after_release_j = 0;  ///< net energy since the release, including that of compressed springs
  /// Energy returned within the last two seconds, in J: accumulated by a vibration in each cycle.
  double returned_j = 0;
  /// Peak-to-peak vibration of the handle above 6 Hz in the last two seconds, with the hand at rest, in m.
  double vibration_m = 0;
  double vibration_before_m = 0;  ///< vibration in the second before
  double damped_share = 0;        ///< fraction of ticks in which the controller changed the force
  double held_n = 0;              ///< mean force in the last second
  double felt_sd_n = 0;           ///< SD of the force in the last second
  double softest = 1;             ///< minimum fraction of the force left by the controller
  LoopEnd end = LoopEnd::kRunning;
};

/// Presses the tool 15 mm into the soil within 1 s, stirs for 2 s at 0.5 Hz, and holds still for 3 s. The device
/// reports quantised positions and their low-passed differences. Its forces have steps of 0.01 N, a maximum of 12 N and
/// a maximum rate of 4000 N/s.
/// @param lying  result of settled(bed).
/// @throws InvalidParameter as Scene and HapticLoop.
[[nodiscard]] StabilityResult measureStability(const BedParameters& bed, const LyingSoil& lying,
                                               const StabilityCase& parameters, const ToolParameters& tool = {});

/// Returns the settled soil of this bed.
[[nodiscard]] LyingSoil settled(const BedParameters& bed);

}  // namespace haptolith

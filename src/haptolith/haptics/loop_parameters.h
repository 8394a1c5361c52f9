#pragma once

#include "haptolith/core/error.h"

namespace haptolith {

inline constexpr int kAnyCpu = -1;

/// The 1 kHz loop: pacing and what happens to the wrench between the soil and the hand.
struct LoopParameters {
  double tick_s = 1e-3;
  double duration_s = 0;         ///< simulated time; 0 runs until stopped
  bool real_time = true;         ///< false: as fast as it can, for tests and studies of the soil
  double filter_cutoff_hz = 30;  ///< low-pass of force and torque (paper, II-E)
  int cpu = kAnyCpu;             ///< the only one that the loop's thread runs on; kAnyCpu leaves it to the system

  [[nodiscard]] bool operator==(const LoopParameters&) const = default;
};

/// Valid ranges; read by validate(), scene files and the command line alike.
struct LoopRanges {
  static constexpr Range tick_s{1e-4, 0.1};
  static constexpr Range duration_s{0, 1e7};
  static constexpr Range filter_cutoff_hz{0.1, 500};  ///< at a tick of 1 ms; half its rate at another
  static constexpr Range cpu{kAnyCpu, 1023};          ///< whether there is such a one: requireUsableCpu()
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const LoopParameters& loop);

}  // namespace haptolith

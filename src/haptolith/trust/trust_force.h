#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include "haptolith/soil/soil_target.h"
#include "haptolith/trust/trust_plan.h"

namespace haptolith {

/// Reach of the tool below the surface, by its bounding box.
struct TrustReach {
  double depth_m = 0;      ///< deepest point below the soil's surface; 0: it stays above
  double to_floor_m = 0;   ///< least height of its lowest point over the floor
  double to_wall_x_m = 0;  ///< least distance of its sunk corners from the walls at the ends of x
  double to_wall_y_m = 0;
};

/// The force of one run: the soil's on the first tool, magnitudes.
struct TrustForce {
  static constexpr double kPeak_s = 0.03;  ///< a peak is a mean over as long: what the loop's filter lets through

  double mean_n = 0;
  double peak_n = 0;
  TrustReach reach;
  double surface_m = 0;  ///< surface of the soil at the beginning, scene frame
  std::size_t particles = 0;
  int substeps = 0;
  double settling_s = 0, movement_s = 0;  ///< time of this machine
  // Energy: work of the tools on the soil, and its increase in the soil. The difference is friction's.
  double work_j = 0, energy_gain_j = 0;
  /// Stress at rest over rho g z, mean of five levels (verticalLoad()); empty where that is not known.
  std::optional<double> stress_ratio{};
  std::uint64_t hash = 0;  ///< hash of the scene at the end
};

/// Called now and then with the current work and the fraction done; returns false to cancel.
using TrustProgress = std::function<bool(std::string_view what, double fraction)>;

/// Simulates a run's movement for `duration_s` with a virtual hand, as `haptolith run --no-realtime` does, on
/// `threads` threads. Its soil settles first or comes from the cache. Not for the tick.
/// @throws Failure when the run ends early or is cancelled; InvalidParameter as Scene.
[[nodiscard]] TrustForce measureForce(const TrustRun& run, double duration_s, int threads,
                                      const TrustProgress& progress = {});

/// Whether a scene is the same bit for bit on one and two threads, and when it is saved in the middle of a movement
/// and continued by another scene; and how well it is computed. Takes three times as long as the movement.
struct TrustBits {
  bool threads = false;
  bool restart = false;
  /// Error of a step in single precision: largest of three steps, root mean square over that of the contact forces (see
  /// compareWithDouble()). Empty where hasDoubleStep() is false.
  std::optional<double> rounding{};
};
[[nodiscard]] TrustBits checkBits(const TrustRun& run, double duration_s, const TrustProgress& progress = {});

/// Strength that a soil was made for, and that a simulated shear test of its particles shows.
struct TrustStrength {
  double asked_deg = 0, shown_deg = 0, error_deg = 0;  ///< friction angle; error: standard error of the test's line
  double asked_pa = 0, shown_pa = 0, error_pa = 0;     ///< cohesion
};

/// Shears a specimen of the soil as its file's target says: to the peak, or until the residual state. Takes about
/// 150 s of one core. @throws as shearTest().
[[nodiscard]] TrustStrength measureStrength(const SoilParameters& soil, const SoilTarget& target, double gravity_m_s2,
                                            int threads, const TrustProgress& progress = {});

}  // namespace haptolith

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"
#include "haptolith/soil/soil_parameters.h"
#include "haptolith/stone/stone_parameters.h"

namespace haptolith {

/// Arrangement of the particles at the first tick.
enum class BedStart {
  kPacked,   ///< close packing at the analytic layer spacing b(n), filled up to `depth_m`
  kRain,     ///< dropped loosely at random and settled without friction, `particles` of them
  kCount,    ///< exactly `particles` in `layers` layers, close-packed: the scene icra2021
  kSettled,  ///< as soil that has settled, at rest: a tile of `depth_m` again and again (bed_tile.h)
  kGiven,    ///< positions of `given`, from a file or another program; then friction builds up and they settle
};

/// Particles with given positions.
struct GivenGrains {
  /// Centres in m; the fourth number is by how much a grain's radius exceeds the soil's. Null: none.
  std::shared_ptr<const std::vector<std::array<float, 4>>> grains;
  std::size_t held = 0;  ///< number of fixed particles, the last ones, outside the sides of the box
  std::string name;      ///< name of the file, for messages; ignored by comparisons

  [[nodiscard]] std::size_t count() const noexcept { return grains == nullptr ? 0 : grains->size(); }
  [[nodiscard]] bool operator==(const GivenGrains& other) const;
};

/// Finer grains where soil is felt, contact friction only: a box of the finest below the surface, around it shells of
/// each coarser class, and everywhere else grains of the soil's own radius (GrainClasses).
struct Grading {
  double fine_radius_m = 0;  ///< R of the finest: the soil's halved once, twice or three times; 0: grains are all alike
  double fine_x_m = 0, fine_y_m = 0;  ///< middle of the fine soil
  double fine_width_m = 0.06;         ///< along x
  double fine_length_m = 0.06;        ///< along y
  double fine_depth_m = 0.02;         ///< from the surface down

  [[nodiscard]] bool operator==(const Grading&) const = default;
};

/// The box of soil: floor at z = 0, walls at x = +-width/2 and y = +-length/2 that end nowhere upwards.
struct BedParameters {
  SoilParameters soil;
  Vec3 gravity_m_s2{0, 0, -1.625};
  double width_m = 0.126;   ///< along x
  double length_m = 0.126;  ///< along y
  bool periodic_x = false;  ///< the box repeats itself along x instead of having walls; then width_m >= 3 reaches
  bool periodic_y = false;  ///< along y
  /// Friction and cohesion of the side walls over those of the soil, contact friction only; the floor has the soil's.
  double wall_friction_ratio = 1;

  BedStart start = BedStart::kCount;
  int particles = 256;     ///< kCount, kRain
  int layers = 3;          ///< kCount
  double depth_m = 0.04;   ///< kPacked, kSettled: height of the undisturbed soil
  std::uint64_t seed = 1;  ///< kRain, kSettled, and finer grains
  bool ready_made =
      false;          ///< kSettled: with settled soil that ships with the program where there is some (ready_tile.h)
  GivenGrains given;  ///< kGiven
  Grading grading;
  StonesParameters stones;  ///< contact friction only, in a box with walls

  /// Whether soil at rest is left alone until something near it stirs (Wakefulness); what moves faster than this is not
  /// at rest, nor what has gone further than the distance from where it came to rest. The default is so slow that
  /// almost no position changes in its last digit. At 0 only motionless particles sleep, as soil with ICRA 2021
  /// friction does, and no bit changes. Digging in large beds wants 0.01 m/s and a hundredth of a radius: grains that
  /// find new places ring like bells, so that soil far from the tool swings at some mm/s, but by a few um only.
  bool sleep = true;
  double sleep_speed_m_s = 1e-6;
  double sleep_distance_m = 0;  ///< 0: as far as it goes at that speed in 20 ms

  double tick_s = 1e-3;
  int max_substeps = 32;  ///< a tick that would need more is refused
  int threads = 1;

  [[nodiscard]] bool operator==(const BedParameters&) const = default;
};

/// No bed is larger: it would need gigabytes and minutes for a tick.
inline constexpr int kMostParticles = 10'000'000;

/// Valid range of each number alone; a box is at least a particle wide, long and deep.
struct BedRanges {
  static constexpr Range gravity_m_s2{0, 1000};
  static constexpr Range length_m{1e-5, 100};  ///< width, length and depth
  static constexpr Range wall_friction_ratio{0, 10};
  static constexpr Range particles{1, kMostParticles};
  static constexpr Range layers{1, 1000};
  static constexpr Range seed{0, 9e15};  ///< as large as a double and a whole number of TOML can be
  static constexpr Range fine_radius_m{0, 0.5};
  static constexpr Range fine_place_m{-100, 100};
  static constexpr Range fine_length_m{1e-5, 100};  ///< width, length and depth of fine soil
  static constexpr Range sleep_speed_m_s{0, 1};
  static constexpr Range sleep_distance_m{0, 1};
  static constexpr Range tick_s{1e-6, 0.1};
  static constexpr Range max_substeps{1, 1000};
  static constexpr Range threads{1, 256};
};

/// After how much a box may repeat itself at least, in m: three cells of the neighbour search, so that no pair
/// touches on both sides.
[[nodiscard]] double shortestPeriod(const SoilParameters& soil);

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const BedParameters& bed);

/// Returns the parameters after validate(): wrong ones stop at the first member that is made of them.
[[nodiscard]] const BedParameters& validated(const BedParameters& bed);

/// Number of particle sizes in a bed: 1 when all are alike. @throws InvalidParameter when `fine_radius_m` is not the
/// soil's halved a few times.
[[nodiscard]] int grainClasses(const BedParameters& bed);

/// The soil of its finest grains. @throws InvalidParameter as grainClasses().
[[nodiscard]] SoilParameters finestSoil(const BedParameters& bed);

}  // namespace haptolith

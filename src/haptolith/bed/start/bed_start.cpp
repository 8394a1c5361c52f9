#include "haptolith/bed/start/bed_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/core/math/random.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/soil/layers.h"

namespace haptolith {

namespace {

/// Hexagonal layers in a box: rows along x, every other row shifted by half a pitch; layers A and B in turn, B shifted
/// by a third of the way between two rows and half a pitch, into the hollows of A.
struct Lattice {
  double width_m, length_m, radius_m;
  double pitch_m;  ///< between neighbours in a row; 2R when undeformed
  double row_m;    ///< between rows; sqrt(3) R when undeformed

  [[nodiscard]] double shiftOfB() const { return row_m / 3; }

  /// Mean square of the sideways distance between a particle and the three it rests on.
  [[nodiscard]] double meanOffsetSquared() const {
    const double to_pair = pitch_m * pitch_m / 4 + shiftOfB() * shiftOfB();
    const double to_single = 4 * shiftOfB() * shiftOfB();
    return (2 * to_pair + to_single) / 3;
  }

  [[nodiscard]] double usableWidth() const { return width_m - 2 * radius_m + kRounding; }
  [[nodiscard]] double usableLength() const { return length_m - 2 * radius_m + kRounding; }

  /// Number of rows in a layer, and of places in one of its rows.
  [[nodiscard]] int rows(bool layer_b) const { return count(usableLength() - (layer_b ? shiftOfB() : 0), row_m); }
  [[nodiscard]] int columns(bool shifted_row) const {
    return count(usableWidth() - (shifted_row ? pitch_m / 2 : 0), pitch_m);
  }
  [[nodiscard]] static bool isShifted(int row, bool layer_b) { return (row % 2 == 1) != layer_b; }

  [[nodiscard]] std::size_t numberOfPlaces(bool layer_b) const {
    const auto n = static_cast<std::size_t>(rows(layer_b));
    const std::size_t even = (n + 1) / 2 * static_cast<std::size_t>(columns(isShifted(0, layer_b)));
    return even + n / 2 * static_cast<std::size_t>(columns(isShifted(1, layer_b)));
  }

  [[nodiscard]] std::vector<Eigen::Vector2d> places(bool layer_b) const {
    // Both layers are centred together, so that B fills the hollows of A.
    const double total_width = (count(2 * usableWidth(), pitch_m) - 1) * pitch_m / 2;
    const bool room_for_shift = (rows(false) - 1) * row_m + shiftOfB() <= usableLength();
    const double total_length = (rows(false) - 1) * row_m + (room_for_shift ? shiftOfB() : 0);

    std::vector<Eigen::Vector2d> places;
    for (int row = 0; row < rows(layer_b); ++row) {
      const double along_y = row * row_m + (layer_b ? shiftOfB() : 0);
      const double start = isShifted(row, layer_b) ? pitch_m / 2 : 0;
      for (int column = 0; column < columns(isShifted(row, layer_b)); ++column) {
        places.emplace_back(start + column * pitch_m - total_width / 2, along_y - total_length / 2);
      }
    }
    return places;
  }

 private:
  static constexpr double kRounding = 1e-9;

  static int count(double length, double pitch) {
    return length < 0 ? 0 : static_cast<int>(std::floor(length / pitch)) + 1;
  }
};

Lattice undeformed(const BedParameters& bed) {
  const double r = bed.soil.radius_m;
  return {bed.width_m, bed.length_m, r, 2 * r, std::sqrt(3.0) * r};
}

std::size_t placesIn(const Lattice& lattice, int layers) {
  const auto a = static_cast<std::size_t>((layers + 1) / 2);
  const auto b = static_cast<std::size_t>(layers / 2);
  return a * lattice.numberOfPlaces(false) + b * lattice.numberOfPlaces(true);
}

/// The least squeezed lattice with room for all: either pitch is the largest that gives one more place than the last.
Lattice squeezedToHold(const BedParameters& bed, std::size_t particles) {
  constexpr double kMostSqueeze = 0.12;
  const Lattice loose = undeformed(bed);
  const double usable_width = bed.width_m - 2 * bed.soil.radius_m;
  const double usable_length = bed.length_m - 2 * bed.soil.radius_m;
  std::vector<double> pitches{loose.pitch_m}, rows{loose.row_m};
  // From the first that is tighter than the undeformed lattice to the tightest allowed.
  for (int halves = 1 + static_cast<int>(2 * usable_width / loose.pitch_m);
       2 * usable_width / halves > loose.pitch_m * (1 - kMostSqueeze); ++halves) {
    pitches.push_back(std::min(loose.pitch_m, 2 * usable_width / halves));
  }
  for (int thirds = 1 + static_cast<int>(3 * usable_length / loose.row_m);
       3 * usable_length / thirds > loose.row_m * (1 - kMostSqueeze); ++thirds) {
    rows.push_back(std::min(loose.row_m, 3 * usable_length / thirds));
  }
  Lattice candidate = loose, found = loose;
  double least = kMostSqueeze;
  bool holds = false;
  for (const double pitch : pitches) {
    for (const double row : rows) {
      candidate.pitch_m = pitch;
      candidate.row_m = row;
      const double squeeze = std::max(1 - pitch / loose.pitch_m, 1 - row / loose.row_m);
      if (squeeze < least && placesIn(candidate, bed.layers) >= particles) {
        least = squeeze;
        found = candidate;
        holds = true;
      }
    }
  }
  if (!holds) {
    throw InvalidParameter("particles", fmt::format("{}", bed.particles),
                           fmt::format("at most about {} in {} layers of this box; use more layers or a larger box",
                                       placesIn(loose, bed.layers), bed.layers));
  }
  return found;
}

double weightAlongZ(const BedParameters& bed) {
  return std::max(0.0, -bed.gravity_m_s2.z());
}

/// Heights of the layers' centres above the floor, lowest first, under their own weight.
std::vector<double> layerHeights(const BedParameters& bed, const Lattice& lattice, int layers) {
  const ContactLaw law = makeContactLaw(bed.soil);
  const double g = weightAlongZ(bed);
  const double weight = macroparticleMass(bed.soil) * g;
  std::vector<double> heights{distanceAtForce(law, layers * weight) / 2};  // the floor carries them all
  const double natural_offset_squared = 4 * bed.soil.radius_m * bed.soil.radius_m / 3;
  for (int above = layers - 1; above >= 1; --above) {
    const double b = layerSpacing(bed.soil, g, above);
    // In a squeezed lattice the centres keep the analysis's distance a (paper 5), so layers stand a little higher.
    heights.push_back(heights.back() + std::sqrt(b * b + natural_offset_squared - lattice.meanOffsetSquared()));
  }
  return heights;
}

std::vector<Vec3> stacked(const BedParameters& bed, const Lattice& lattice, int layers) {
  std::vector<Vec3> centres;
  const std::vector<double> heights = layerHeights(bed, lattice, layers);
  for (int layer = 0; layer < layers; ++layer) {
    for (const Eigen::Vector2d& place : lattice.places(layer % 2 == 1)) {
      centres.emplace_back(place.x(), place.y(), heights[static_cast<std::size_t>(layer)]);
    }
  }
  return centres;
}

std::vector<Vec3> packed(const BedParameters& bed) {
  // As many layers as reach the wanted height: the analysis's surface lies half a spacing above the top centres.
  const Lattice lattice = undeformed(bed);
  const ContactLaw law = makeContactLaw(bed.soil);
  const double g = weightAlongZ(bed);
  const double weight = macroparticleMass(bed.soil) * g;
  const double radius = bed.soil.radius_m;
  int layers = 1;
  double first_to_last = 0;
  while (distanceAtForce(law, layers * weight) / 2 + first_to_last + radius < bed.depth_m - radius / 2) {
    if (placesIn(lattice, layers) > kMostParticles) {
      throw InvalidParameter(
          "depth_m", fmt::format("{:g}", bed.depth_m),
          fmt::format("at most about {:.3g} in a box of this size; more needs over {} particles of R = {:g} mm",
                      first_to_last + 2 * radius, kMostParticles, 1e3 * radius));
    }
    first_to_last += layerSpacing(bed.soil, g, layers++);
  }
  return stacked(bed, lattice, layers);
}

std::vector<Vec3> counted(const BedParameters& bed) {
  const auto particles = static_cast<std::size_t>(bed.particles);
  const Lattice lattice = squeezedToHold(bed, particles);
  std::vector<Vec3> centres = stacked(bed, lattice, bed.layers);
  const std::size_t surplus = centres.size() - particles;
  const std::size_t top_layer = lattice.numberOfPlaces(bed.layers % 2 == 0);
  if (surplus >= top_layer) {
    throw InvalidParameter("layers", fmt::format("{}", bed.layers),
                           fmt::format("fewer: {} particles do not reach the top layer", bed.particles));
  }
  // Surplus places are those of the top layer furthest from the middle: its corners.
  std::stable_sort(centres.end() - static_cast<std::ptrdiff_t>(top_layer), centres.end(),
                   [](const Vec3& a, const Vec3& b) { return a.head<2>().squaredNorm() < b.head<2>().squaredNorm(); });
  centres.resize(particles);
  return centres;
}

/// A loose lattice: cells of 1.15 diameters of the largest particle leave it 0.15 R of play to all sides, so that each
/// seed makes a different bed and no particle touches another. (The laboratory's loose specimens, lab_bed.cpp, are
/// looser.)
std::vector<Vec3> rained(const BedParameters& bed) {
  const double largest =
      bed.soil.radius_m * (1 + (bed.soil.friction == FrictionModel::kContact ? bed.soil.size_spread : 0));
  const double cell = 2.3 * largest;
  const double play = cell / 2 - largest;
  const int columns = std::max(1, static_cast<int>(bed.width_m / cell));
  const int rows = std::max(1, static_cast<int>(bed.length_m / cell));
  std::mt19937_64 random(bed.seed);
  const auto jitter = [&] { return play * uniformSigned(random); };
  std::vector<Vec3> centres;
  for (int i = 0; i < bed.particles; ++i) {
    const int column = i % columns;
    const int row = i / columns % rows;
    const int storey = i / columns / rows;
    Vec3 centre((column + 0.5 - columns / 2.0) * cell, (row + 0.5 - rows / 2.0) * cell, (storey + 0.5) * cell);
    for (int axis = 0; axis < 3; ++axis) {
      centre[axis] += jitter();
    }
    centres.push_back(centre);
  }
  return centres;
}

}  // namespace

std::vector<Vec3> startingCentres(const BedParameters& bed) {
  validate(bed);
  switch (bed.start) {
    case BedStart::kPacked: return packed(bed);
    case BedStart::kRain: return rained(bed);
    case BedStart::kCount: return counted(bed);
    case BedStart::kSettled:
    case BedStart::kGiven: break;
  }
  return {};
}

void requireGravityToSettle(const BedParameters& bed, double fall_m) {
  constexpr double kFalling = 0.8;  // fraction of the time
  const double gravity_m_s2 = bed.gravity_m_s2.norm();
  const double least_m_s2 = double{kSettlingDrag_per_s} * fall_m / (kFalling * kLongestSettling_s);
  if (gravity_m_s2 > 0 && gravity_m_s2 < least_m_s2) {
    throw InvalidParameter(
        "gravity_m_s2", fmt::format("{:g}", gravity_m_s2),
        fmt::format(
            ">= {:.2g} for soil that falls {:.3g} m; start = \"packed\" or \"given\" also works without gravity",
            least_m_s2, fall_m));
  }
}

double highestCentre(const std::vector<Float4>& grains) {
  float height = 0;
  for (const Float4& grain : grains) {
    height = std::max(height, grain.z);
  }
  return height;
}

BedParameters withRoomFor(int particles, BedParameters bed) {
  constexpr double kVolumePerCubedRadius = 5.83;  // volume of a particle with its part of the gaps, walls included
  constexpr double kDeepest_m = 0.12;
  const double volume = particles * kVolumePerCubedRadius * portable::cube(bed.soil.radius_m);
  bed.start = BedStart::kPacked;
  bed.depth_m = std::min(portable::cbrt(volume / 4), kDeepest_m);
  bed.width_m = bed.length_m = std::sqrt(volume / bed.depth_m);
  return bed;
}

double largestExcess(const SoilParameters& soil) {
  return soil.friction == FrictionModel::kContact ? soil.size_spread * soil.radius_m : 0;
}

std::vector<Float4> withSizes(const BedParameters& bed, const std::vector<Vec3>& centres_m) {
  std::mt19937_64 random(bed.seed);
  std::vector<Float4> grains;
  grains.reserve(centres_m.size());
  for (const Vec3& centre : centres_m) {
    const double excess = largestExcess(bed.soil) * uniformSigned(random);
    grains.push_back({static_cast<float>(centre.x()), static_cast<float>(centre.y()), static_cast<float>(centre.z()),
                      static_cast<float>(excess)});
  }
  return grains;
}

}  // namespace haptolith

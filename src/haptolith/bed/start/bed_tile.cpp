#include "haptolith/bed/start/bed_tile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/bed/start/bed_start.h"
#include "haptolith/bed/start/spatial_order.h"
#include "haptolith/core/error.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/soil/layers.h"

namespace haptolith {

namespace {

/// Edge of a tile, in radii, where the box does not prescribe one: twenty grains, so that a copy's neighbours are not
/// felt to be copies, and some thousand grains, which settle in seconds.
constexpr double kEdgeRadii = 40;

/// No tile is larger: it would take minutes to settle.
constexpr double kMostTileParticles = 1e6;

/// Poured amount over that of a close packing: rain is a tenth looser, and some is left to be levelled.
constexpr double kPoured = 0.97;

/// Poured soil is calm when the mean kinetic energy of its particles would lift one by less than this
/// fraction of its radius. Without friction single particles continue to rearrange for a long time: lunar-0-15cm of
/// 3.5 mm, 35 mm deep, is there after 3 s of simulated time, and sinks by another 0.5 % in the next 19.
constexpr double kPouredLift = 1e-4;

/// Soil that has not settled after this fraction of the time limit is accepted once it is as calm as poured soil.
constexpr double kCalmAfter = 0.9;

/// A tile is at rest when nothing in it moves faster. Its speeds are then forgotten. With ICRA 2021 friction,
/// which has no memory, as in Bed::settle(): stiff soil keeps creeping at a third of that.
double restSpeed(FrictionModel friction) {
  return friction == FrictionModel::kIcra2021 ? 1e-4 : 1e-5;  // m/s
}

/// The length nearest to the usual edge of which a whole number makes up a box that repeats itself; else the edge.
double edge(double box_m, bool periodic, double radius_m, double shortest_m) {
  const double usual = std::max(kEdgeRadii * radius_m, shortest_m);
  return periodic ? box_m / std::clamp(std::round(box_m / usual), 1.0, std::max(1.0, std::floor(box_m / shortest_m)))
                  : usual;
}

double pouredParticles(const BedParameters& tile) {
  const SoilParameters& soil = tile.soil;
  const double depth_m = tile.depth_m + 2 * soil.radius_m;
  const std::vector<Layer> layers = layersToDepth(soil, tile.gravity_m_s2.norm(), depth_m);
  const double mass_kg = bandMeanDensity(layers, 0, depth_m) * depth_m * tile.width_m * tile.length_m;
  return kPoured * mass_kg / macroparticleMass(soil);
}

double meanSquareSpeed(const Bed& bed) {
  double sum = 0;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Float4& v = bed.state().velocity[i];
    sum += v.x * v.x + v.y * v.y + v.z * v.z;
  }
  return sum / static_cast<double>(bed.particles());
}

/// Steps until `is_calm` returns true, checked after the given time and below the given speed.
void stepUntil(Bed& bed, const TileProgress& progress,
               const std::function<bool(double time_s, double speed)>& is_calm) {
  constexpr int kStepsBetweenLooks = 100;
  const BedParameters& tile = bed.parameters();
  const double dt_s = tile.tick_s / substepsFor(tile.soil, 0, tile.tick_s, tile.max_substeps);
  double time_s = 0;
  double speed = 0;
  do {
    if (time_s >= kLongestSettling_s) {
      throw Failure(fmt::format("the soil did not settle within {:g} s: its fastest particle moves at {:.2g} m/s",
                                kLongestSettling_s, speed));
    }
    for (int i = 0; i < kStepsBetweenLooks; ++i) {
      if (const StepStatus status = bed.step(dt_s); status != StepStatus::kOk) {
        throw Failure(fmt::format("the soil did not settle: {}", text(status)));
      }
    }
    time_s += kStepsBetweenLooks * dt_s;
    speed = bed.largestSpeed();
    if (stopAsked() || (progress && !progress(time_s, speed))) {
      throw Failure(fmt::format("interrupted while the soil settled, after {:.1f} s of simulated time", time_s));
    }
  } while (!is_calm(time_s, speed));
}

/// The particles of a bed up to the requested depth.
std::vector<Float4> levelled(const Bed& bed) {
  std::vector<Float4> grains;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Float4& grain = bed.state().position[i];
    if (grain.z + grain.w + bed.parameters().soil.radius_m <= bed.parameters().depth_m) {
      grains.push_back(grain);
    }
  }
  return grains;
}

/// Time of a free fall through the depth of a tile, in s: at first nothing moves.
double fallingTime(const BedParameters& tile) {
  return std::sqrt(2 * tile.depth_m / tile.gravity_m_s2.norm());
}

bool isCalm(const Bed& bed) {
  return meanSquareSpeed(bed) < 2 * kPouredLift * bed.parameters().gravity_m_s2.norm() * bed.parameters().soil.radius_m;
}

/// Soil that has fallen without friction, as dense as it then lies, and is levelled. With ICRA 2021 friction it sinks
/// slowly in what damps against space, and is waited for as any rain.
std::vector<Float4> poured(const BedParameters& tile, const TileProgress& progress) {
  if (tile.soil.friction == FrictionModel::kIcra2021) {
    return levelled(Bed(tile, progress));
  }
  Bed bed(tile, inSpatialOrder(startingCentres(tile), tile.soil.radius_m));
  requireGravityToSettle(tile, bed.surfaceHeight() - tile.depth_m);
  bed.setSettling(true);
  stepUntil(bed, progress, [&](double time_s, double) { return time_s > fallingTime(tile) && isCalm(bed); });
  return levelled(bed);
}

/// Reduces a coordinate by complete periods to the interval about 0.
float aboutMiddle(float metres, double period_m) {
  return static_cast<float>(metres - period_m * std::round(metres / period_m));
}

BedTile tileOf(const Bed& bed) {
  const BedState& state = bed.state();
  const auto n = static_cast<std::uint32_t>(bed.particles());
  BedTile tile{bed.parameters().width_m, bed.parameters().length_m, {}, {}, {}, {}};
  for (std::uint32_t i = 0; i < n; ++i) {
    const Float4& p = state.position[i];
    tile.grains.push_back({aboutMiddle(p.x, tile.width_m), aboutMiddle(p.y, tile.length_m), p.z, p.w});
    tile.firsts.push_back(static_cast<std::uint32_t>(tile.contacts.size()));
    for (std::uint32_t s = 0; state.contacts.remembers() && s < state.contacts.count(i); ++s) {
      const Slip slip = state.contacts.slip(i, s);
      if (slip.x != 0 || slip.y != 0 || slip.z != 0) {
        tile.contacts.push_back({static_cast<std::uint32_t>(state.contacts.neighbour(i, s)), slip});
      }
    }
    if (state.contacts.remembers()) {
      const WallSlips& walls = state.wall_slip[i / kGroup];
      tile.floor_slips.push_back({walls.floor_x[i % kGroup], walls.floor_y[i % kGroup], 0});
    }
  }
  tile.firsts.push_back(static_cast<std::uint32_t>(tile.contacts.size()));
  return tile;
}

/// Number of copies that cover a box from its centre to one side.
int copiesToSide(double box_m, double tile_m) {
  return static_cast<int>(std::ceil((box_m / tile_m - 1) / 2 - 1e-9));
}

/// Centres of the copies along one axis. In a periodic box their number may be even, and the centre
/// of the box between two of them.
std::vector<double> middles(double box_m, double tile_m, bool periodic) {
  std::vector<double> at;
  if (periodic) {
    const int copies = static_cast<int>(std::round(box_m / tile_m));
    for (int i = 0; i < copies; ++i) {
      at.push_back((i - (copies - 1) / 2.0) * tile_m);
    }
  } else {
    const int side = std::max(0, copiesToSide(box_m, tile_m));
    for (int i = -side; i <= side; ++i) {
      at.push_back(i * tile_m);
    }
  }
  return at;
}

}  // namespace

BedParameters tileBed(const BedParameters& bed) {
  // As validate() asks for: three reaches, so that no pair touches on both sides.
  BedParameters tile = bed;
  const double shortest = shortestPeriod(bed.soil);
  tile.width_m = edge(bed.width_m, bed.periodic_x, bed.soil.radius_m, shortest);
  tile.length_m = edge(bed.length_m, bed.periodic_y, bed.soil.radius_m, shortest);
  tile.periodic_x = tile.periodic_y = true;
  tile.wall_friction_ratio = 1;
  tile.gravity_m_s2 = {0, 0, -bed.gravity_m_s2.norm()};
  tile.start = BedStart::kRain;
  tile.sleep = false;
  const double particles = pouredParticles(tile);
  if (particles > kMostTileParticles) {
    throw InvalidParameter("depth_m", fmt::format("{:g}", bed.depth_m),
                           fmt::format("at most about {:.2g}, or settling would take too long",
                                       bed.depth_m * kMostTileParticles / particles));
  }
  tile.particles = std::max(1, static_cast<int>(particles));
  return tile;
}

BedTile settledTile(const BedParameters& bed, const TileProgress& progress) {
  const BedParameters wanted = tileBed(bed);
  const std::vector<Float4> grains = poured(wanted, progress);
  if (grains.empty()) {
    throw InvalidParameter("depth_m", fmt::format("{:g}", bed.depth_m), "deeper than one layer of particles");
  }
  // With friction, which was off so far: its springs now carry their part.
  Bed rest(wanted, grains);
  // Without friction it never comes to a stop, and with very little not in time: then it is as calm as what is poured.
  const bool flows = wanted.soil.friction == FrictionModel::kContact && wanted.soil.contact_friction == 0;
  const double calm_after_s = flows ? fallingTime(wanted) : kCalmAfter * kLongestSettling_s;
  stepUntil(rest, progress, [&, still_m_s = restSpeed(wanted.soil.friction)](double time_s, double speed) {
    return speed <= still_m_s || (time_s > calm_after_s && isCalm(rest));
  });
  return tileOf(rest);
}

double heldWidth(const BedParameters& bed) {
  const bool has_held = bed.start == BedStart::kSettled || (bed.start == BedStart::kGiven && bed.given.held > 0);
  if (!has_held) {
    return 0;
  }
  return makeContactLaw(bed.soil).cutoff_m + 2 * largestExcess(bed.soil);
}

double wallRatio(const BedParameters& bed) {
  return heldWidth(bed) > 0 ? 0 : bed.wall_friction_ratio;
}

LaidSoil laidOut(const BedTile& tile, const BedParameters& bed) {
  const double held_m = heldWidth(bed);
  const double width_m = bed.width_m + (bed.periodic_x ? 0 : 2 * held_m);
  const double length_m = bed.length_m + (bed.periodic_y ? 0 : 2 * held_m);
  const double in_all = static_cast<double>(tile.grains.size()) * width_m / tile.width_m * length_m / tile.length_m;
  if (in_all > kMostParticles) {
    throw InvalidParameter(
        "depth_m", fmt::format("{:g}", bed.depth_m),
        fmt::format("less: a box of this size would hold {:.3g} particles of R = {:g} mm; the maximum is {}", in_all,
                    1e3 * bed.soil.radius_m, kMostParticles));
  }
  // Overlap of a particle with the sides: none if that is not above 0.
  const auto in_sides = [&bed](const Vec3& centre, double radius_m) {
    return std::max(bed.periodic_x ? 0 : std::abs(centre.x()) + radius_m - bed.width_m / 2,
                    bed.periodic_y ? 0 : std::abs(centre.y()) + radius_m - bed.length_m / 2);
  };
  struct Part {
    std::vector<Vec3> centres;
    std::vector<std::uint32_t> sources;
  } free, held;
  for (const double y : middles(length_m, tile.length_m, bed.periodic_y)) {
    for (const double x : middles(width_m, tile.width_m, bed.periodic_x)) {
      for (std::size_t i = 0; i < tile.grains.size(); ++i) {
        const Float4& grain = tile.grains[i];
        const Vec3 centre(grain.x + x, grain.y + y, grain.z);
        const double in_m = in_sides(centre, bed.soil.radius_m + grain.w);
        if (in_m <= held_m) {
          Part& part = in_m <= 0 ? free : held;
          part.centres.push_back(centre);
          part.sources.push_back(static_cast<std::uint32_t>(i));
        }
      }
    }
  }
  if (free.centres.empty()) {
    throw InvalidParameter("width_m", fmt::format("{:g}", bed.width_m), "room for one particle");
  }
  LaidSoil soil{.grains = {}, .sources = {}, .free = free.centres.size()};
  for (const Part* part : {&free, &held}) {
    for (const std::size_t point : spatialOrder(part->centres, bed.soil.radius_m)) {
      const Vec3& centre = part->centres[point];
      const std::uint32_t source = part->sources[point];
      soil.sources.push_back(source);
      soil.grains.push_back({static_cast<float>(centre.x()), static_cast<float>(centre.y()),
                             static_cast<float>(centre.z()), tile.grains[source].w});
    }
  }
  return soil;
}

}  // namespace haptolith

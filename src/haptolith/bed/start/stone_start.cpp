// Which stones there are, where they are at first, and how soil makes room for them.

#include "haptolith/bed/start/stone_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/core/math/random.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/core/turn.h"

namespace haptolith {

namespace {

/// Number of shapes of rocks at random places, each with another rotation: making one takes a few milliseconds.
constexpr std::uint64_t kRockShapes = 12;

/// Soil deeper in a stone than this share of its radius is not there with it, and the stone grows into the rest. With 1
/// it would be as much soil as the stone is large; but particles are looser next to a wall, as Desmond and Weeks 2009
/// (Phys. Rev. E 80, 051305) found for close packings: here as if the stone were a third of R larger all around
/// (Stones.SoilAroundThemIsAsDenseAsElsewhere).
constexpr double kDeepest = 0.65;
constexpr double kGrowing_s = 0.2;

/// A bed with stones has settled when nothing in it moves faster than this, or after this simulated
/// time.
constexpr double kAtRest_m_s = 2e-3;
constexpr double kLongestBedding_s = 3;

double uniform(std::mt19937_64& random, double lowest, double highest) {
  return std::lerp(lowest, highest, (uniformSigned(random) + 1) / 2);
}

/// A shape in another size.
StoneShape resized(StoneShape shape, double scale) {
  for (StoneSphere& sphere : shape.spheres) {
    sphere.centre_m *= scale;
    sphere.radius_m *= scale;
  }
  for (Vec3& point_m : shape.shown.points_m) {
    point_m *= scale;
  }
  shape.volume_m3 *= scale * scale * scale;
  shape.inertia_m5 *= portable::cube(scale) * scale * scale;
  shape.reach_m *= scale;
  return shape;
}

StoneShape shapeOf(const PlacedStone& stone) {
  switch (stone.form) {
    case StoneForm::kRock: return angularRock(stone.size_m, stone.seed);
    case StoneForm::kSphere: return roundStone(stone.size_m);
    case StoneForm::kSpheres: return makeStoneShape(stone.spheres);
  }
  return {};
}

/// Sizes of which N(> D) ~ D^-exponent between the smallest and the largest, the largest first.
std::vector<double> sizesOf(const StonesParameters& stones, std::mt19937_64& random) {
  std::vector<double> sizes_m(static_cast<std::size_t>(stones.count));
  for (double& size_m : sizes_m) {
    const double share = uniform(random, 0, 1);
    const double e = stones.exponent;
    size_m = e == 0 ? stones.smallest_m * portable::pow(stones.largest_m / stones.smallest_m, share)
                    : portable::pow(
                          std::lerp(portable::pow(stones.largest_m, -e), portable::pow(stones.smallest_m, -e), share),
                          -1 / e);
  }
  std::ranges::sort(sizes_m, std::greater());
  return sizes_m;
}

/// Any turn, each as likely (Shoemake 1992).
Quat anyTurn(std::mt19937_64& random) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double u = uniform(random, 0, 1);
  const double a = uniform(random, 0, kTurn);
  const double b = uniform(random, 0, kTurn);
  const double s = std::sqrt(1 - u);
  const double t = std::sqrt(u);
  return {t * portable::cos(b), s * portable::sin(a), s * portable::cos(a), t * portable::sin(b)};
}

/// Stones that already stand somewhere.
class StandingStone {
 public:
  [[nodiscard]] bool hasRoomFor(const StoneShape& shape, const Vec3& place_m) const {
    return std::ranges::none_of(
        stones_, [&](const auto& stone) { return (stone.second - place_m).norm() < stone.first + shape.reach_m; });
  }
  void add(const StoneShape& shape, const Vec3& place_m) { stones_.emplace_back(shape.reach_m, place_m); }

 private:
  std::vector<std::pair<double, Vec3>> stones_;  ///< reach, place
};

}  // namespace

StonesOfBed stonesOf(const StonesParameters& stones) {
  StonesOfBed all;
  for (const PlacedStone& stone : stones.placed) {
    all.shapes.push_back(std::make_shared<const StoneShape>(shapeOf(stone)));
    all.fixed.push_back(stone.fixed);
  }
  std::mt19937_64 random(stones.seed);
  std::vector<StoneShape> kinds;
  std::uint64_t next = 0;
  for (const double size_m : sizesOf(stones, random)) {
    if (kinds.size() < (stones.form == StoneForm::kRock ? kRockShapes : 1)) {
      kinds.push_back(stones.form == StoneForm::kRock ? angularRock(1, stones.seed * kRockShapes + next)
                                                      : roundStone(1));
    }
    all.shapes.push_back(std::make_shared<const StoneShape>(resized(kinds[next++ % kinds.size()], size_m)));
    all.fixed.push_back(stones.fixed);
  }
  return all;
}

bool isInStone(const Stones& stones, const Float4& grain, double radius_m) {
  const double own_m = radius_m + grain.w;
  return stones.depthOf({grain.x, grain.y, grain.z}, own_m) > kDeepest * own_m;
}

std::vector<Pose> startingPlaces(const BedParameters& bed, const Stones& stones, double surface_m) {
  std::vector<Pose> places;
  StandingStone standing;
  const auto room_beside = [&](const StoneShape& shape) {
    return std::pair(bed.width_m / 2 - shape.reach_m, bed.length_m / 2 - shape.reach_m);
  };
  for (const PlacedStone& stone : bed.stones.placed) {
    const StoneShape& shape = *stones.shape(places.size());
    const Vec3 place(stone.x_m, stone.y_m, surface_m - stone.depth_m);
    const auto [width_m, length_m] = room_beside(shape);
    const bool fits = std::abs(place.x()) <= width_m && std::abs(place.y()) <= length_m;
    if (!stone.fixed && (!fits || place.z() < shape.reach_m)) {
      throw InvalidParameter(
          "stones.placed",
          fmt::format("a stone {:.4g} mm wide at {:g}, {:g} mm, {:g} mm deep", 2e3 * shape.reach_m, 1e3 * stone.x_m,
                      1e3 * stone.y_m, 1e3 * stone.depth_m),
          fmt::format("completely in the box: x within {:.4g} mm, y within {:.4g} mm, at most {:.4g} mm deep",
                      1e3 * width_m, 1e3 * length_m, 1e3 * (surface_m - shape.reach_m)));
    }
    standing.add(shape, place);
    places.push_back({place, turnAboutXyz(stone.turn_rad)});
  }
  std::mt19937_64 random(bed.stones.seed + 1);
  constexpr int kTries = 2000;
  while (places.size() < stones.size()) {
    const StoneShape& shape = *stones.shape(places.size());
    const auto [width_m, length_m] = room_beside(shape);
    bool found = false;
    for (int t = 0; t < kTries && !found && width_m >= 0 && length_m >= 0; ++t) {
      const double depth_m = uniform(random, bed.stones.shallowest_m, bed.stones.deepest_m);
      const Vec3 place{uniform(random, -width_m, width_m), uniform(random, -length_m, length_m),
                       std::max(surface_m - depth_m, shape.reach_m)};
      found = standing.hasRoomFor(shape, place);
      if (found) {
        standing.add(shape, place);
        places.push_back({place, anyTurn(random)});
      }
    }
    if (!found) {
      throw InvalidParameter("stones.count", fmt::format("{}", bed.stones.count),
                             fmt::format("fewer or smaller stones: of {:.3g} mm one of {:.3g} mm found no room",
                                         1e3 * bed.stones.smallest_m, 2e3 * shape.radius()));
    }
  }
  return places;
}

void Bed::makeStones() {
  if (parameters_.stones.any()) {
    const StonesOfBed all = stonesOf(parameters_.stones);
    stones_ = Stones(parameters_, skin_m_, all.shapes, all.fixed);
  }
}

void Bed::placeStones(const std::vector<Pose>& places) {
  if (!places.empty() && places.size() != stones_.size()) {
    throw InvalidParameter("stones", fmt::format("{} places", places.size()),
                           fmt::format("one for each of {} stones", stones_.size()));
  }
  const bool has_depth = parameters_.start == BedStart::kSettled || parameters_.start == BedStart::kPacked;
  const double surface_m = has_depth ? parameters_.depth_m : surfaceHeight();
  const std::vector<Pose> all = places.empty() ? startingPlaces(parameters_, stones_, surface_m) : places;
  for (std::size_t i = 0; i < all.size(); ++i) {
    stones_.place(i, all[i]);
  }
}

void Bed::moveOutOfStones() {
  const double radius_m = parameters_.soil.radius_m;
  std::vector<std::size_t> displaced;
  for (std::size_t i = 0; i < particles(); ++i) {
    if (!isDriven(i) && isInStone(stones_, state_.position[i], radius_m)) {
      displaced.push_back(i);
    }
  }
  // The top of a column of soil and stones, as wide as a particle.
  std::mt19937_64 random(parameters_.stones.seed + 2);
  std::vector<bool> gone(particles());
  for (const std::size_t i : displaced) {
    gone[i] = true;
  }
  std::vector<Vec3> put;
  const double grain_m = (1 + parameters_.soil.size_spread) * radius_m;
  for (const std::size_t i : displaced) {
    constexpr int kTries = 8;
    Vec3 lowest = Vec3::Constant(std::numeric_limits<double>::max());
    for (int t = 0; t < kTries; ++t) {
      Vec3 place{uniform(random, grain_m - parameters_.width_m / 2, parameters_.width_m / 2 - grain_m),
                 uniform(random, grain_m - parameters_.length_m / 2, parameters_.length_m / 2 - grain_m), grain_m};
      const auto raise_above = [&](const Vec3& other, double reach_m) {
        const double beside = (other - place).head<2>().squaredNorm();
        if (beside < reach_m * reach_m) {
          place.z() = std::max(place.z(), other.z() + std::sqrt(reach_m * reach_m - beside));
        }
      };
      const auto wide = [&](double sign) {
        return Float4{static_cast<float>(place.x() + sign * 3 * grain_m),
                      static_cast<float>(place.y() + sign * 3 * grain_m), sign < 0 ? 0.0F : 1e3F, 0};
      };
      neighbourhood_.forEachIn(neighbourhood_.placeOf(wide(-1), wide(1)), [&](std::int32_t particle) {
        const auto j = static_cast<std::size_t>(particle);
        const Float4& q = state_.position[j];
        if (!gone[j]) {
          raise_above({q.x, q.y, q.z}, 2 * grain_m);
        }
      });
      for (const Vec3& other : put) {
        raise_above(other, 2 * grain_m);
      }
      for (std::size_t s = 0; s < stones_.size(); ++s) {
        for (std::size_t k = 0; k < stones_.spheres(s).size(); ++k) {
          raise_above(stones_.spheres(s)[k], stones_.shape(s)->spheres[k].radius_m + grain_m);
        }
      }
      lowest = place.z() < lowest.z() ? place : lowest;
    }
    for (std::uint32_t s = 0; s < state_.contacts.count(i); ++s) {
      wake(static_cast<std::size_t>(state_.contacts.neighbour(i, s)));
    }
    place(i, lowest);
    put.push_back(lowest);
  }
}

void Bed::bedStones(const SettleProgress& progress) {
  moveOutOfStones();
  const double dt_s = parameters_.tick_s / substepsFor(parameters_, 0);
  constexpr int kStepsBetweenLooks = 100;
  const double grain_m = (1 + parameters_.soil.size_spread) * parameters_.soil.radius_m;
  double time_s = -kGrowing_s;
  double speed_m_s = 0;
  do {
    for (int i = 0; i < kStepsBetweenLooks; ++i) {
      const double to_grow_s = std::max(0.0, -(time_s + (i + 1) * dt_s));
      stones_.growIn(kDeepest * grain_m * to_grow_s / kGrowing_s);
      if (const StepStatus status = step(dt_s); status != StepStatus::kOk) {
        throw Failure(fmt::format("the soil around the stones did not settle: {}", text(status)));
      }
      stones_.slowDown(dt_s);
    }
    time_s += kStepsBetweenLooks * dt_s;
    speed_m_s = std::max(largestSpeed(), stones_.largestSpeed());
    if (stopAsked() || (progress && !progress(kGrowing_s + time_s, speed_m_s))) {
      throw Failure(
          fmt::format("interrupted while the stones settled, after {:.1f} s of simulated time", kGrowing_s + time_s));
    }
  } while (time_s < kLongestBedding_s && (time_s <= 0 || speed_m_s > kAtRest_m_s));
  for (std::size_t i = 0; i < particles(); ++i) {
    state_.velocity[i] = isDriven(i) ? state_.velocity[i] : Float4{};
  }
  next_velocity_ = state_.velocity;
  stones_.stop();
  state_.step = 0;
}

}  // namespace haptolith

// How a bed comes to be: what it is laid of, and how that comes to rest.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/bed_start.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/bed/graded_start.h"
#include "haptolith/bed/spatial_order.h"
#include "haptolith/bed/tile_cache.h"
#include "haptolith/core/error.h"

namespace haptolith {

namespace {

/// Simulated time after which falling particles that still move are given up: they calm down within a minute, and sink
/// for as long as the deep ones among them take, with a margin.
double longestSettling(const BedParameters& bed, double height_m, double dt_s) {
  return 60 + 3 * sinkingTime(bed.soil, bed.gravity_m_s2.norm(), height_m, dt_s);
}

/// While laid soil finds its hold at the walls, what moves no faster is at rest. The wider the box, the faster it may
/// move: with 1e-3 m/s a million of lunar-0-15cm goes on moving from wall to wall, for soil slumps into the room that
/// was left there and carries the rest with it. A bed without walls lies still to 1e-6 m/s.
double laidRest(const BedParameters& bed) {
  constexpr double kSmallBox_m_s = 1e-3;
  constexpr double kShiver_per_s = 1.5e-3;  // m/s for each m from the middle
  return std::max(kSmallBox_m_s, kShiver_per_s * std::max(bed.width_m, bed.length_m) / 2);
}
/// A bed that lets soil sleep which moves so fast starts asleep; a stricter one finds out for itself.
constexpr double kStartsAsleep_m_s = 1e-3;
/// Simulated time after which what still moves there is given up.
constexpr double kLongestLaying_s = 60;
/// Nobody further from a wall, in radii, misses a neighbour that was left out for it.
constexpr double kRimRadii = 5;

/// Grains of several sizes, class by class, ordered so that a group's 16 have about as many neighbours: it takes as
/// long as the one of them that has most, and next to finer ones a grain has four times as many as among its like.
std::vector<Float4> withManyNeighboursTogether(const Bed& bed) {
  const ContactLists& lists = bed.state().contacts;
  std::vector<std::size_t> order(bed.particles());
  std::vector<std::uint32_t> neighbours(bed.particles());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
    bool of_other_size = false;
    for (std::uint32_t s = 0; s < lists.count(i); ++s) {
      of_other_size |= bed.classOf(static_cast<std::size_t>(lists.neighbour(i, s))) != bed.classOf(i);
    }
    neighbours[i] = of_other_size ? lists.count(i) : 0;  // all others stay in spatial order
  }
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return std::tuple(bed.classOf(a), neighbours[b]) < std::tuple(bed.classOf(b), neighbours[a]);
  });
  std::vector<Float4> grains;
  grains.reserve(order.size());
  for (const std::size_t i : order) {
    grains.push_back(bed.state().position[i]);
  }
  return grains;
}

/// Grains of one size as they lie before they settle, of several after it.
std::vector<Float4> startingGrains(const BedParameters& bed, const SettleProgress& progress) {
  if (grainClasses(bed) == 1) {
    return withSizes(bed, inSpatialOrder(startingCentres(bed), bed.soil.radius_m));
  }
  const auto grains_of = [](const Bed& made) {
    const auto& position = made.state().position;
    return std::vector<Float4>(position.begin(), position.begin() + static_cast<std::ptrdiff_t>(made.particles()));
  };
  return cachedGradedGrains(bed, [&] {
    const auto settled = [&](const BedParameters& of_one_size) { return grains_of(Bed(of_one_size, progress)); };
    BedParameters coarse = bed;
    coarse.grading = {};
    Bed together(bed, gradedGrains(bed, settled(coarse), settled));
    const double dt_s = bed.tick_s / substepsFor(bed, 0);
    together.settle(dt_s, longestSettling(bed, together.surfaceHeight(), dt_s), progress);
    return withManyNeighboursTogether(together);
  });
}

}  // namespace

Bed::Bed(const BedParameters& parameters, const SettleProgress& progress)
    : Bed(parameters, startingSoil(validated(parameters), progress), progress) {}

Bed::Bed(const BedParameters& parameters, const StartingSoil& soil, const SettleProgress& progress)
    : Bed(parameters, soil.laid.grains) {
  const double dt_s = parameters.tick_s / substepsFor(parameters, 0);
  if (grainClasses(parameters) > 1) {
    return;  // settled together already
  }
  if (parameters.start == BedStart::kRain) {
    settle(dt_s, longestSettling(parameters, surfaceHeight(), dt_s), progress);
  }
  if (parameters.start == BedStart::kSettled) {
    recall(soil);
    settleRim(dt_s, progress);
  }
}

Bed::StartingSoil Bed::startingSoil(const BedParameters& bed, const SettleProgress& progress) {
  if (bed.start != BedStart::kSettled || grainClasses(bed) > 1) {
    return {.tile = {}, .laid = {.grains = startingGrains(bed, progress), .sources = {}}};
  }
  StartingSoil soil{.tile = cachedTile(bed, progress), .laid = {}};
  soil.laid = laidOut(soil.tile, bed);
  return soil;
}

void Bed::settle(double dt_s, double longest_s, const SettleProgress& progress) {
  // With contact friction a thousandth of what a particle gains in falling by its diameter: what only contacts damp
  // sways for minutes in a large bed. What the paper's damping holds sinks more slowly than that.
  const double falling_m_s = std::sqrt(4 * parameters_.gravity_m_s2.norm() * parameters_.soil.radius_m);
  const double at_rest_m_s = hasContactFriction() ? std::max(1e-4, 1e-3 * falling_m_s) : 1e-4;
  constexpr int kStepsBetweenLooks = 100;
  setSettling(true);
  const struct FrictionAgain {  // however this ends
    Bed& bed;
    ~FrictionAgain() { bed.setSettling(false); }
  } friction_again{*this};
  double time_s = 0;
  double speed = 0;
  do {
    if (time_s >= longest_s) {
      throw Failure(
          fmt::format("the bed did not come to rest within {:g} s: its fastest particle still moves at {:.2g} "
                      "m/s",
                      longest_s, speed));
    }
    for (int i = 0; i < kStepsBetweenLooks; ++i) {
      if (const StepStatus status = step(dt_s); status != StepStatus::kOk) {
        throw Failure(fmt::format("the bed did not settle: {}", text(status)));
      }
    }
    time_s += kStepsBetweenLooks * dt_s;
    speed = largestSpeed();
    if (progress && !progress(time_s, speed)) {
      throw Failure(fmt::format("interrupted while the bed settled, after {:.1f} s of simulated time", time_s));
    }
  } while (speed > at_rest_m_s);
  wakefulness_.wakeAll(state_);
  for (std::size_t i = 0; i < particles(); ++i) {
    state_.velocity[i] = isDriven(i) ? state_.velocity[i] : Float4{};
  }
  state_.step = 0;
}

void Bed::recall(const StartingSoil& soil) noexcept {
  if (!hasContactFriction()) {
    return;
  }
  for (std::size_t i = 0; i < particles(); ++i) {
    const std::uint32_t source = soil.laid.sources[i];
    const Slip& floor = soil.tile.floor_slips[source];
    WallSlips& walls = state_.wall_slip[i / kGroup];
    walls.floor_x[i % kGroup] = floor.x;
    walls.floor_y[i % kGroup] = floor.y;
    // A tile is three reaches wide and more, so of each of its grains one copy at most is in a list.
    const auto first = soil.tile.contacts.begin() + soil.tile.firsts[source];
    const auto last = soil.tile.contacts.begin() + soil.tile.firsts[source + 1];
    for (std::uint32_t s = 0; first != last && s < state_.contacts.count(i); ++s) {
      const std::uint32_t other = soil.laid.sources[static_cast<std::size_t>(state_.contacts.neighbour(i, s))];
      const auto contact = std::find_if(first, last, [other](const TileContact& c) { return c.other == other; });
      if (contact != last) {
        state_.contacts.setSlip(i, s, contact->slip);
      }
    }
  }
  std::ranges::fill(near_walls_, std::uint8_t{0xFF});
}

void Bed::settleRim(double dt_s, const SettleProgress& progress) {
  const RestRule own = wakefulness_.rule();
  BedParameters laying = parameters_;
  laying.sleep = true;
  laying.sleep_speed_m_s = laidRest(parameters_);
  wakefulness_.setRule(restRule(laying));
  laying_ = true;
  const double rim_m = kRimRadii * parameters_.soil.radius_m;
  const bool upright = parameters_.gravity_m_s2.x() == 0 && parameters_.gravity_m_s2.y() == 0;
  const auto inside = [&](const Float4& p) {  // the ghosts behind the last particle, too
    return (parameters_.periodic_x || std::abs(p.x) < parameters_.width_m / 2 - rim_m || p.x == kGhost.x) &&
           (parameters_.periodic_y || std::abs(p.y) < parameters_.length_m / 2 - rim_m || p.y == kGhost.y);
  };
  for (std::size_t group = 0; group < state_.rested.size(); ++group) {
    const auto first = state_.position.begin() + static_cast<std::ptrdiff_t>(group * kGroup);
    state_.rested[group] = upright && std::all_of(first, first + static_cast<std::ptrdiff_t>(kGroup), inside)
                               ? BedState::kAsleep
                               : std::uint16_t{0};
  }
  wakefulness_.takeOver(state_);
  wakefulness_.listAwake();
  constexpr int kStepsBetweenLooks = 100;
  double time_s = 0;
  while (awake() > 0 && (time_s == 0 || largestSpeed() > laying.sleep_speed_m_s)) {
    if (time_s >= kLongestLaying_s) {
      throw Failure(fmt::format("the soil at the walls did not come to rest within {:g} s", kLongestLaying_s));
    }
    for (int i = 0; i < kStepsBetweenLooks && awake() > 0; ++i) {
      if (const StepStatus status = step(dt_s); status != StepStatus::kOk) {
        throw Failure(fmt::format("the soil at the walls did not settle: {}", text(status)));
      }
    }
    time_s += kStepsBetweenLooks * dt_s;
    if (progress && !progress(time_s, largestSpeed())) {
      throw Failure(fmt::format("interrupted while the bed settled, after {:.1f} s of simulated time", time_s));
    }
  }
  for (std::size_t i = 0; i < particles(); ++i) {
    state_.velocity[i] = {};
  }
  next_position_ = state_.position;  // who sleeps stands in both
  next_velocity_ = state_.velocity;
  laying_ = false;
  const bool sleeps = own.sleep && own.speed_m_s >= static_cast<float>(kStartsAsleep_m_s);
  std::ranges::fill(state_.rested, sleeps ? BedState::kAsleep : std::uint16_t{0});
  state_.rested_at = state_.position;
  wakefulness_.setRule(own);
  wakefulness_.takeOver(state_);
  wakefulness_.listAwake();
  state_.step = 0;
}

}  // namespace haptolith

// Makes a bed: lays its particles and settles them.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/bed/start/bed_start.h"
#include "haptolith/bed/start/graded_start.h"
#include "haptolith/bed/start/ready_tile.h"
#include "haptolith/bed/start/spatial_order.h"
#include "haptolith/bed/start/stone_start.h"
#include "haptolith/bed/start/tile_cache.h"
#include "haptolith/core/error.h"
#include "haptolith/core/stop_asked.h"

namespace haptolith {

namespace {

/// Simulated time after which falling particles that still move are given up: they calm down within a minute, and sink
/// for as long as the deep ones among them take, with a margin.
double longestSettling(const BedParameters& bed, double height_m, double dt_s) {
  return kLongestSettling_s + 3 * sinkingTime(bed.soil, bed.gravity_m_s2.norm(), height_m, dt_s);
}

/// Number of times that a graded bed is filled and settled: where sizes are joined gaps close, and cohesion draws soil
/// together that has settled without. After the third time it sinks by less than a tenth of a coarse grain's radius.
constexpr int kFillings = 3;

/// Soil laid on a slope is at rest when nothing in it moves faster,
constexpr double kLaidRest_m_s = 1e-3;
/// soil with given positions when nothing does so,
constexpr double kGivenRest_m_s = 2e-5;
/// and either is given up after this simulated time.
constexpr double kLongestLaying_s = 60;

/// Free grains of several sizes, class by class, ordered so that a group's 16 have about as many neighbours: it takes
/// as long as the one of them that has most, and next to finer ones a grain has four times as many as among its like.
std::vector<Float4> withManyNeighboursTogether(const Bed& bed) {
  const ContactLists& lists = bed.state().contacts;
  std::vector<std::size_t> order(bed.particles() - bed.heldParticles());
  std::vector<std::uint32_t> neighbours(order.size());
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

BedParameters withoutStones(BedParameters bed) {
  bed.stones = {};
  return bed;
}

/// Soil of a given depth is where stones are not. (That of a given number of grains has as many with them, see
/// bedStones(); and so has graded soil, whose grains stand in groups.)
template <class StartingSoil>
StartingSoil clearedOfStones(StartingSoil soil, const BedParameters& bed) {
  const bool has_depth = bed.start == BedStart::kSettled || bed.start == BedStart::kPacked;
  if (!bed.stones.any() || !has_depth || grainClasses(bed) > 1) {
    return soil;
  }
  const StonesOfBed all = stonesOf(bed.stones);
  Stones stones(bed, 0, all.shapes, all.fixed);
  const std::vector<Pose> places = startingPlaces(bed, stones, bed.depth_m);
  for (std::size_t i = 0; i < places.size(); ++i) {
    stones.place(i, places[i]);
  }
  auto& laid = soil.laid;
  const std::size_t free = laid.sources.empty() ? laid.grains.size() : laid.free;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < laid.grains.size(); ++i) {
    if (i < free && isInStone(stones, laid.grains[i], bed.soil.radius_m)) {
      continue;
    }
    laid.grains[kept] = laid.grains[i];
    if (!laid.sources.empty()) {
      laid.sources[kept] = laid.sources[i];
    }
    ++kept;
  }
  laid.free -= std::min(laid.free, laid.grains.size() - kept);
  laid.grains.resize(kept);
  laid.sources.resize(laid.sources.empty() ? 0 : kept);
  if (laid.grains.empty()) {
    throw InvalidParameter("stones", "in place of all the soil", "with soil around them");
  }
  return soil;
}

/// The tile of a bed that starts as settled.
BedTile tileFor(const BedParameters& bed, const TileProgress& progress) {
  std::optional<BedTile> ready = bed.ready_made ? readyTile(bed) : std::nullopt;
  return ready ? *std::move(ready) : cachedTile(bed, progress);
}

/// Given grains in spatial order, those that are held last.
LaidSoil givenSoil(const BedParameters& bed) {
  const std::vector<std::array<float, 4>>& given = *bed.given.grains;
  LaidSoil soil{.grains = {}, .sources = {}, .free = given.size() - bed.given.held};
  soil.grains.reserve(given.size());
  for (const auto& [first, last] : {std::pair(std::size_t{0}, soil.free), std::pair(soil.free, given.size())}) {
    std::vector<Vec3> centres;
    for (std::size_t i = first; i < last; ++i) {
      centres.emplace_back(given[i][0], given[i][1], given[i][2]);
    }
    for (const std::size_t point : spatialOrder(centres, bed.soil.radius_m)) {
      const auto& [x, y, z, excess] = given[first + point];
      soil.grains.push_back({x, y, z, excess});
    }
  }
  return soil;
}

}  // namespace

Bed::Bed(const BedParameters& parameters, const SettleProgress& progress)
    : Bed(parameters, clearedOfStones(startingSoil(withoutStones(validated(parameters)), progress), parameters),
          progress) {
  if (parameters.stones.any()) {
    makeStones();
    placeStones({});
    bedStones(progress);
  }
}

Bed::Bed(const BedParameters& parameters, const StartingSoil& soil, const SettleProgress& progress)
    : Bed(parameters, soil.laid.grains, highestCentre(soil.laid.grains)) {
  const double dt_s = parameters.tick_s / substepsFor(parameters, 0);
  if (grainClasses(parameters) > 1) {  // settled together already, but what contacts remembered is not kept
    if (soil.laid.free < soil.laid.grains.size()) {
      holdSides(soil.laid.free);
    }
    findHold(dt_s, kGivenRest_m_s, progress);
    return;
  }
  if (parameters.start == BedStart::kRain) {
    const double lies_m = static_cast<double>(particles()) * laws_.mass_kg /
                          (parameters.soil.rho0_kg_m3 * parameters.width_m * parameters.length_m);
    requireGravityToSettle(parameters, surfaceHeight() - lies_m);
    settle(dt_s, longestSettling(parameters, surfaceHeight(), dt_s), progress);
  }
  if (parameters.start == BedStart::kSettled) {
    recall(soil);
    holdSides(soil.laid.free);
    const bool on_a_slope = parameters_.gravity_m_s2.x() != 0 || parameters_.gravity_m_s2.y() != 0;
    if (on_a_slope) {
      findHold(dt_s, kLaidRest_m_s, progress);
    }
  }
  if (parameters.start == BedStart::kGiven) {
    holdSides(soil.laid.free);
    findHold(dt_s, kGivenRest_m_s, progress);
  }
}

Bed::StartingSoil Bed::startingSoil(const BedParameters& bed, const SettleProgress& progress) {
  if (bed.start == BedStart::kGiven) {
    return {.tile = {}, .laid = givenSoil(bed)};
  }
  if (grainClasses(bed) > 1) {
    return {.tile = {}, .laid = gradedSoil(bed, progress)};
  }
  if (bed.start != BedStart::kSettled) {
    const std::vector<Vec3> centres = inSpatialOrder(startingCentres(bed), bed.soil.radius_m);
    return {.tile = {}, .laid = {.grains = withSizes(bed, centres), .sources = {}}};
  }
  StartingSoil soil{.tile = tileFor(bed, progress), .laid = {}};
  soil.laid = laidOut(soil.tile, bed);
  return soil;
}

LaidSoil Bed::gradedSoil(const BedParameters& bed, const SettleProgress& progress) {
  std::optional<LyingSoil> made;
  const auto coarse = [&]() -> const LyingSoil& {
    if (!made) {
      BedParameters of_one_size = bed;
      of_one_size.grading = {};
      of_one_size.ready_made = false;
      made = Bed(of_one_size, progress).lying();
    }
    return *made;
  };
  LaidSoil soil;
  soil.grains = cachedGradedGrains(bed, [&] {
    const GradedFilling filling(
        bed, coarse(), [&](const BedParameters& of_one_size) { return Bed(of_one_size, progress).lying().grains; });
    const double dt_s = bed.tick_s / substepsFor(bed, 0);
    std::vector<Float4> free;
    for (int time = 0; time < kFillings; ++time) {
      Bed together(bed, filling.filledUp(free));
      together.settle(dt_s, longestSettling(bed, together.surfaceHeight(), dt_s), progress);
      together.findHold(dt_s, kGivenRest_m_s, progress);  // cohesion draws it together, by about 4 % in lunar soil
      free = withManyNeighboursTogether(together);
    }
    return free;
  });
  soil.free = soil.grains.size();
  if (heldWidth(bed) > 0) {
    const LyingSoil& lying = coarse();
    soil.grains.insert(soil.grains.end(), lying.grains.end() - static_cast<std::ptrdiff_t>(lying.held),
                       lying.grains.end());
  }
  return soil;
}

void Bed::settle(double dt_s, double longest_s, const SettleProgress& progress) {
  // With contact friction a thousandth of what a particle gains in falling by its diameter: what only contacts damp
  // sways for minutes in a large bed. Soil held by ICRA 2021 damping sinks more slowly than that.
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
      throw Failure(fmt::format("the bed did not settle within {:g} s: its fastest particle moves at {:.2g} m/s",
                                longest_s, speed));
    }
    for (int i = 0; i < kStepsBetweenLooks; ++i) {
      if (const StepStatus status = step(dt_s); status != StepStatus::kOk) {
        throw Failure(fmt::format("the bed did not settle: {}", text(status)));
      }
    }
    time_s += kStepsBetweenLooks * dt_s;
    speed = largestSpeed();
    if (stopAsked() || (progress && !progress(time_s, speed))) {
      throw Failure(fmt::format("interrupted while the bed settled, after {:.1f} s of simulated time", time_s));
    }
  } while (speed > at_rest_m_s);
  stop();
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

std::size_t Bed::heldParticles() const noexcept {
  std::size_t held = 0;
  for (std::size_t i = 0; i < particles(); ++i) {
    held += state_.isHeld(i) ? 1 : 0;
  }
  return held;
}

LyingSoil Bed::lying() const {
  const auto end = state_.position.begin() + static_cast<std::ptrdiff_t>(particles());
  return {.grains = {state_.position.begin(), end}, .held = heldParticles(), .stones = stones().poses()};
}

void Bed::holdSides(std::size_t free_particles) noexcept {
  for (std::size_t i = free_particles; i < particles(); ++i) {
    state_.velocity[i].w = BedState::kHeld;
  }
  next_velocity_ = state_.velocity;
  const auto start = wakefulness_.rule().sleep ? BedState::kAsleep : std::uint16_t{0};
  for (std::size_t group = 0; group < state_.rested.size(); ++group) {
    state_.rested[group] = group * kGroup >= free_particles ? BedState::kAsleepForEver : start;
  }
  wakefulness_.takeOver(state_);
  wakefulness_.listAwake();
}

void Bed::findHold(double dt_s, double rest_m_s, const SettleProgress& progress) {
  wakefulness_.wakeAll(state_);
  laying_ = true;
  constexpr int kStepsBetweenLooks = 100;
  double time_s = 0;
  do {
    if (time_s >= kLongestLaying_s) {
      throw Failure(
          fmt::format("the placed soil did not settle within {:g} s: its fastest particle moves at {:.2g} m/s",
                      kLongestLaying_s, largestSpeed()));
    }
    for (int i = 0; i < kStepsBetweenLooks; ++i) {
      if (const StepStatus status = step(dt_s); status != StepStatus::kOk) {
        throw Failure(fmt::format("the placed soil did not settle: {}", text(status)));
      }
    }
    time_s += kStepsBetweenLooks * dt_s;
    if (stopAsked() || (progress && !progress(time_s, largestSpeed()))) {
      throw Failure(fmt::format("interrupted while the bed settled, after {:.1f} s of simulated time", time_s));
    }
  } while (largestSpeed() > rest_m_s);
  laying_ = false;
  stop();
}

void Bed::stop() noexcept {
  wakefulness_.wakeAll(state_);
  for (std::size_t i = 0; i < particles(); ++i) {
    state_.velocity[i] = isDriven(i) ? state_.velocity[i] : Float4{};
  }
  state_.step = 0;
}

}  // namespace haptolith

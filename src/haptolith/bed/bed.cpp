#include "haptolith/bed/bed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "haptolith/bed/start/bed_start.h"
#include "haptolith/bed/start/spatial_order.h"
#include "haptolith/core/assert.h"
#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"

namespace haptolith {

namespace {

/// Extra reach of the neighbour lists in radii. Larger: longer lists for every step; smaller: particles that move have
/// to be entered again more often. At 0.5 the next shell of a close packing (2 sqrt(2) R) stays just outside.
constexpr double kSkinRadii = 0.5;

/// Margin of the inner list, in radii: neighbours further apart than a contact reaches plus this margin cannot touch
/// until one has moved half the margin. Rows that hold only such neighbours are skipped (InnerRows). Larger: more rows
/// in every step; smaller: more frequent pruning.
constexpr double kInnerSkinRadii = 0.1;

/// In a box as wide as this a position is known to 3e-8 m: in substeps of a third of a millisecond everything that is
/// faster than 0.05 mm/s moves. In wider boxes remainders are kept.
constexpr double kExactWidth_m = 1;

/// Awake groups whose records do not fit into a core's caches: 32 768 particles of about 600 bytes.
constexpr std::size_t kGroupsBeyondCache = 2048;

/// Smallest number of particles per thread for which waking one more, about 100 us, is worthwhile; contacts with
/// friction take three times as long as those of icra2021, with several substeps per tick. Two threads become faster
/// than one there in `haptolith bench` on two cores, to a power of two.
std::size_t particlesPerThread(FrictionModel friction) {
  return friction == FrictionModel::kContact ? 512 : 4096;
}

int usefulThreads(const BedParameters& bed, std::size_t particles) {
  return std::clamp(static_cast<int>(particles / particlesPerThread(bed.soil.friction)), 1, bed.threads);
}

/// Number of parts of a loop: many small ones, so that a preempted thread delays the step by one part at most.
int mostParts(int threads) {
  constexpr int kPartsPerThread = 32;
  return threads == 1 ? 1 : kPartsPerThread * threads;
}

/// Number of parts for a number of groups: each large enough that taking it costs a few per cent of it at most.
int partsFor(const BedParameters& bed, std::size_t groups, int threads) {
  constexpr std::size_t kGroupsPerPart = 8;
  return usefulThreads(bed, groups * kGroup) == 1
             ? 1
             : std::clamp(static_cast<int>(groups / kGroupsPerPart), 1, mostParts(threads));
}

template <class To, class From>
To narrow(From value) noexcept {
  return static_cast<To>(value);
}

StepBox stepBox(const BedParameters& bed) {
  const double held_m = heldWidth(bed);
  return {.half_width = narrow<float>(bed.width_m / 2 + held_m),
          .half_length = narrow<float>(bed.length_m / 2 + held_m),
          .walls_x = !bed.periodic_x,
          .walls_y = !bed.periodic_y,
          .wall_ratio = narrow<float>(wallRatio(bed)),
          .periods = periodsOf(bed)};
}

GridBox gridBox(const BedParameters& bed, double height_m) {
  const double held_m = 2 * heldWidth(bed);
  return {bed.width_m + (bed.periodic_x ? 0 : held_m), bed.length_m + (bed.periodic_y ? 0 : held_m), height_m,
          periodsOf(bed)};
}

/// Groups first..last-1 of a part of the work.
struct GroupRange {
  std::size_t first, last;
};
GroupRange groupsOf(int part, int parts, std::size_t groups) {
  const auto share = [&](int p) { return groups * static_cast<std::size_t>(p) / static_cast<std::size_t>(parts); };
  return {share(part), share(part + 1)};
}

}  // namespace

const char* text(StepStatus status) noexcept {
  switch (status) {
    case StepStatus::kOk: return "ok";
    case StepStatus::kNotFinite: return "a position or velocity is not finite";
    case StepStatus::kCollapsed: return "the bed collapsed: too many particles in one place";
  }
  return "";
}

Bed::Bed(const BedParameters& parameters, const std::vector<Vec3>& centres_m, const std::vector<Pose>& stones)
    : Bed(parameters, withSizes(validated(parameters), centres_m), stones) {}

Bed::Bed(const BedParameters& parameters, const std::vector<Float4>& grains, const std::vector<Pose>& stones)
    : Bed(parameters, grains, highestCentre(grains)) {
  makeStones();
  placeStones(stones);
}

Bed::Bed(const BedParameters& parameters, const LyingSoil& lying) : Bed(parameters, lying.grains, lying.stones) {
  if (lying.held > 0) {
    holdSides(lying.grains.size() - std::min(lying.held, lying.grains.size()));
  }
}

Bed::Bed(const BedParameters& parameters, const std::vector<Float4>& grains, double grid_height_m)
    : parameters_(validated(parameters)),
      laws_(parameters.soil, grainClasses(parameters)),
      box_(stepBox(parameters)),
      skin_m_(narrow<float>(kSkinRadii * parameters.soil.radius_m)),
      neighbourhood_(grains.size(),
                     {.classes = laws_.graded.classes,
                      .reach_m = laws_.pair.cutoff_m + skin_m_,
                      .beyond_m = laws_.pair.cutoff_m + skin_m_ - laws_.pair.diameter_m,
                      .largest_excess_m = largestExcess(parameters.soil)},
                     gridBox(parameters, grid_height_m)),
      grid_height_m_(grid_height_m),
      wakefulness_(paddedCount(grains.size()) / kGroup, restRule(parameters)),
      changed_(paddedCount(grains.size()) / kGroup),
      team_(usefulThreads(parameters, grains.size())),
      moved_of_part_(static_cast<std::size_t>(mostParts(team_.size()))) {
  transitions_by_part_.resize(moved_of_part_.size());
  const std::size_t n = grains.size();
  const std::size_t padded = paddedCount(n);
  for (const Float4& grain : grains) {
    if (!std::isfinite(grain.x) || !std::isfinite(grain.y) || !std::isfinite(grain.z)) {
      throw InvalidParameter("centres_m", fmt::format("{} {} {}", grain.x, grain.y, grain.z), "finite");
    }
  }
  state_.position = grains;
  state_.position.resize(padded, kGhost);
  state_.velocity.resize(n);
  state_.velocity.resize(padded, kGhostVelocity);
  state_.particle_count = n;
  if (std::max(parameters_.width_m, parameters_.length_m) > kExactWidth_m) {
    state_.remainder.resize(padded);
  }
  noteClasses();
  state_.reference_position = state_.position;
  state_.rested.resize(padded / kGroup);
  state_.rested_at = state_.position;
  state_.contacts = ContactLists(n, hasContactFriction());
  next_velocity_ = state_.velocity;
  next_position_ = state_.position;
  external_.resize(padded);
  contact_force_.resize(padded);
  moved_.resize(padded);
  keep_awake_.resize(nearGroups().bits().size());
  pushed_.reserve(padded / kGroup);
  is_pushed_.resize(padded / kGroup);
  if (hasContactFriction()) {
    state_.wall_slip.resize(padded / kGroup);
    near_walls_.resize(padded / kGroup);
  }
  if (!neighbourhood_.buildAll(state_.reference_position, state_.contacts)) {
    throw InvalidParameter("centres_m", fmt::format("{} particles", n), "apart from each other");
  }
  if (team_.size() > 1 && grain_class_.empty()) {  // graded beds gain nothing
    wakefulness_.setOrder(groupsInSlabs(grains, parameters.soil.radius_m));
  }
}

void Bed::noteClasses() {
  if (classes().count() == 1) {
    return;
  }
  grain_class_.resize(state_.position.size() / kGroup);
  for (std::size_t i = 0; i < particles(); ++i) {
    const auto own = narrow<std::uint8_t>(classOf(i));
    if (i % kGroup == 0) {
      grain_class_[i / kGroup] = own;
    } else if (grain_class_[i / kGroup] != own) {
      throw InvalidParameter("grains", fmt::format("group {} with two sizes", i / kGroup),
                             "in groups of 16 of one size");
    }
  }
}

std::vector<Bed::GrainRun> Bed::grainRuns() const {
  if (grain_class_.empty()) {
    return {{.grain_class = 0, .count = particles()}};
  }
  std::vector<GrainRun> runs;
  for (std::size_t first = 0; first < particles(); first += kGroup) {
    const int own = grain_class_[first / kGroup];
    if (runs.empty() || runs.back().grain_class != own) {
      runs.push_back({.grain_class = own, .count = 0});
    }
    runs.back().count += std::min(kGroup, particles() - first);
  }
  return runs;
}

StepStatus Bed::step(double dt_s) noexcept {
  HAPTO_ASSERT(dt_s > 0);
  HAPTO_ASSERT(external_.size() == state_.position.size());
  now_ = constantsFor(dt_s);
  takeBackPushes();
  if (stones_.size() > 0 && !pressStones(dt_s)) {
    return StepStatus::kCollapsed;
  }
  wakefulness_.listAwake();  // groups may have been woken since the last step
  parts_ = partsFor(parameters_, wakefulness_.awake().size(), team_.size());
  ++changes_;
  team_.run([](void* bed, int part, int parts) noexcept { static_cast<Bed*>(bed)->stepPart(part, parts); }, this,
            parts_);
  state_.position.swap(next_position_);
  state_.velocity.swap(next_velocity_);
  ++state_.step;
  pushes_felt_ = true;
  if (stones_.size() > 0) {
    stones_.takeBackForces(external_);
    stones_.move(parameters_.gravity_m_s2, dt_s, wakefulness_.rule());
    if (!stones_.areFinite()) {
      return StepStatus::kNotFinite;
    }
  }
  for (const Moved& moved : movedOfParts()) {
    if (!moved.finite) {
      return StepStatus::kNotFinite;
    }
  }
  pruneIfMovedFar(dt_s);
  if (!rebuildListsOfMoved()) {
    return StepStatus::kCollapsed;
  }
  wakeAndLetSleep();
  return StepStatus::kOk;
}

bool Bed::sharesSteps() const noexcept {
  return partsFor(parameters_, wakefulness_.awake().size(), team_.size()) > 1;
}

bool Bed::pressStones(double dt_s) noexcept {
  struct Work {
    Stones& stones;
    SoilAroundStones soil;
  } work{stones_, {state_, external_, neighbourhood_, wakefulness_}};
  stones_.begin(dt_s);
  team_.run(
      [](void* context, int part, int parts) noexcept {
        const auto& shared = *static_cast<Work*>(context);
        shared.stones.press(shared.soil, part, parts);
      },
      &work, team_.size() == 1 ? 1 : stones_.parts());
  return stones_.putForces(work.soil);
}

StepConstants Bed::constantsFor(double dt_s) const noexcept {
  const SoilParameters& soil = parameters_.soil;
  const Vec3 weight = laws_.mass_kg * parameters_.gravity_m_s2;
  const double mu_hat = friction_on_ ? soil.mu_hat : 0;
  return {.dt = narrow<float>(dt_s),
          .weight_x = narrow<float>(weight.x()),
          .weight_y = narrow<float>(weight.y()),
          .weight_z = narrow<float>(weight.z()),
          .inverse_mass = narrow<float>(1 / laws_.mass_kg),
          .skin_half_squared = skin_m_ * skin_m_ / 4,
          .rest_squared = wakefulness_.rule().speed_m_s * wakefulness_.rule().speed_m_s,
          .pruning_pass = pruning_pass_,
          .inner_skin_m = narrow<float>(kInnerSkinRadii * GrainClasses::scale(classes().count() - 1) * soil.radius_m),
          // c = k dt / 2 for each contact (paper 20), with the step that is really taken
          .damping = narrow<float>(soil.stiffness_n_m * dt_s / 2),
          .static_friction = narrow<float>(mu_hat),
          .moving_friction = narrow<float>(mu_hat * soil.moving_friction_ratio),
          .friction_ratio = friction_on_ ? 1.0F : 0.0F,
          .drag = friction_on_ && !laying_ ? 1 : 1 / (1 + kSettlingDrag_per_s * narrow<float>(dt_s))};
}

void Bed::push(std::uint32_t group, const std::array<Float4, kGroup>& forces_n) noexcept {
  HAPTO_ASSERT(group < is_pushed_.size());
  takeBackPushes();
  if (is_pushed_[group] == 0) {
    is_pushed_[group] = 1;
    pushed_.push_back(group);
  }
  Float4* const to = external_.data() + group * kGroup;
  for (std::size_t i = 0; i < kGroup; ++i) {
    to[i] = {to[i].x + forces_n[i].x, to[i].y + forces_n[i].y, to[i].z + forces_n[i].z, 0};
  }
}

/// Those that a step has felt.
void Bed::takeBackPushes() noexcept {
  if (!std::exchange(pushes_felt_, false)) {
    return;
  }
  for (const std::uint32_t group : pushed_) {
    std::fill_n(external_.data() + group * kGroup, kGroup, Float4{});
    is_pushed_[group] = 0;
  }
  pushed_.clear();
}

std::span<const std::uint32_t> Bed::groupsNear(NearGroups& near, const Vec3& centre_m, double radius_m) noexcept {
  HAPTO_ASSERT(radius_m >= 0);
  const double reach = radius_m + skin_m_ / 2;  // particles are not further from their places in the grid
  const auto corner = [&](double sign) {
    return Float4{narrow<float>(centre_m.x() + sign * reach), narrow<float>(centre_m.y() + sign * reach),
                  narrow<float>(centre_m.z() + sign * reach), 0};
  };
  near.find(neighbourhood_.placeOf(corner(-1), corner(1)), neighbourhood_);
  for (const std::uint32_t group : near.listed()) {
    wakefulness_.wake(group, state_);
  }
  std::ranges::transform(keep_awake_, near.bits(), keep_awake_.begin(), std::bit_or{});
  return near.listed();
}

void Bed::stepPart(int part, int parts) noexcept {
  HAPTO_ASSERT(part >= 0 && part < parts);
  HAPTO_ASSERT(parts_ <= static_cast<int>(moved_of_part_.size()));
  const auto [first, last] = groupsOf(part, parts, wakefulness_.awake().size());
  ContactLists& lists = state_.contacts;
  const StepArrays arrays{.groups = wakefulness_.awake().data(),
                          .beyond_cache = wakefulness_.awake().size() >= kGroupsBeyondCache,
                          .position = state_.position.data(),
                          .velocity = state_.velocity.data(),
                          .external = external_.data(),
                          .reference_position = state_.reference_position.data(),
                          .grain_class = grain_class_.empty() ? nullptr : grain_class_.data(),
                          .other = lists.others(),
                          .first_row = lists.firstRows(),
                          .rows = lists.rowCounts(),
                          .slip = lists.slips(),
                          .touched = lists.touchedRows(),
                          .inner = lists.innerRows(),
                          .remainder = state_.remainder.empty() ? nullptr : state_.remainder.data(),
                          .wall_slip = state_.wall_slip.data(),
                          .near_walls = near_walls_.data(),
                          .next_position = next_position_.data(),
                          .next_velocity = next_velocity_.data(),
                          .contact_force = driven_ > 0 ? contact_force_.data() : nullptr,
                          .moving = wakefulness_.moving()};
  Moved moved{moved_.data() + first * kGroup};
  if (hasContactFriction()) {
    stepWithContactFriction(laws_.graded, now_, box_, arrays, first, last, moved);
  } else {
    stepWithIcra2021Friction(laws_.kernel, now_, box_, arrays, first, last, moved);
  }
  for (std::size_t k = first; k < last; ++k) {
    changed_[wakefulness_.awake()[k]] = changes_;
  }
  moved_of_part_[static_cast<std::size_t>(part)] = moved;
  transitions_by_part_[static_cast<std::size_t>(part)] = wakefulness_.updateRest(first, last, next_position_, state_);
}

void Bed::pruneIfMovedFar(double dt_s) noexcept {
  constexpr double kRounded = 0.98;  // margin for rounded positions and distances
  float fastest_squared = 0;
  for (const Moved& moved : movedOfParts()) {
    fastest_squared = std::max(fastest_squared, moved.fastest_squared);
  }
  const double moved_m = std::sqrt(double{fastest_squared}) * dt_s;
  moved_since_pruning_m_ += moved_m;
  stones_.soilMoved(moved_m);
  if (moved_since_pruning_m_ > kRounded * now_.inner_skin_m / 2) {
    ++pruning_pass_;
    moved_since_pruning_m_ = 0;
  }
}

bool Bed::rebuildListsOfMoved() noexcept {
  std::size_t count = 0;  // close the gaps between the parts
  for (const Moved& moved : movedOfParts()) {
    std::copy_n(moved.particle, moved.count, moved_.data() + count);
    count += moved.count;
  }
  if (count == 0) {
    return true;
  }
  std::sort(moved_.begin(), moved_.begin() + static_cast<std::ptrdiff_t>(count));  // independent of the threads
  list_rebuilds_ += count;
  const std::int64_t start_ns = monotonicNs();
  const bool fits =
      neighbourhood_.rebuild({moved_.data(), count}, state_.position, state_.reference_position, state_.contacts);
  for (std::size_t k = 0; k < count; ++k) {
    wakefulness_.wakeAround(static_cast<std::size_t>(moved_[k]), state_);  // they may have new neighbours
  }
  rebuilding_ns_ += monotonicNs() - start_ns;
  return fits;
}

void Bed::wakeAndLetSleep() noexcept {
  const Wakefulness::Transitions found =
      wakefulness_.mergeTransitions({transitions_by_part_.data(), static_cast<std::size_t>(parts_)});
  wakefulness_.wakeBeside({found.disturbed, found.disturbed_count}, state_);
  wakefulness_.putToSleep({found.ready_to_sleep, found.ready_to_sleep_count}, keep_awake_,
                          {.state = state_, .next_position = next_position_, .next_velocity = next_velocity_});
  std::ranges::fill(keep_awake_, std::uint64_t{0});
  wakefulness_.listAwake();
}

void Bed::setSettling(bool settling) noexcept {
  if (friction_on_ == settling) {
    wakefulness_.wakeAll(state_);
  }
  friction_on_ = !settling;
}

void Bed::setGravity(const Vec3& gravity_m_s2) noexcept {
  if (gravity_m_s2 != parameters_.gravity_m_s2) {
    wakefulness_.wakeAll(state_);
    stones_.wakeAll();
  }
  parameters_.gravity_m_s2 = gravity_m_s2;
}

void Bed::setSoil(const SoilLaws& laws) noexcept {
  HAPTO_ASSERT(laws.soil.friction == parameters_.soil.friction);
  HAPTO_ASSERT(laws.soil.radius_m == parameters_.soil.radius_m);
  wakefulness_.wakeAll(state_);
  adjustSoil(laws);
  ++pruning_pass_;  // its contacts may reach further
}

void Bed::adjustSoil(const SoilLaws& laws) noexcept {
  parameters_.soil = laws.soil;
  laws_ = laws;
  stones_.setSoil(laws.soil);
}

void Bed::drive(std::size_t particle, const Vec3& velocity_m_s) noexcept {
  HAPTO_ASSERT(particle < particles());
  HAPTO_ASSERT(state_.velocity[particle].w != BedState::kHeld);
  driven_ += state_.velocity[particle].w == BedState::kDriven ? 0 : 1;
  wake(particle);
  state_.velocity[particle] = {narrow<float>(velocity_m_s.x()), narrow<float>(velocity_m_s.y()),
                               narrow<float>(velocity_m_s.z()), BedState::kDriven};
}

void Bed::release(std::size_t particle) noexcept {
  HAPTO_ASSERT(particle < particles());
  driven_ -= state_.velocity[particle].w == BedState::kDriven ? 1 : 0;
  wake(particle);
  state_.velocity[particle].w = 0;
}

void Bed::place(std::size_t particle, const Vec3& position_m) noexcept {
  HAPTO_ASSERT(particle < particles());
  wake(particle);
  const Float4 place{narrow<float>(position_m.x()), narrow<float>(position_m.y()), narrow<float>(position_m.z()),
                     state_.position[particle].w};
  for (auto* positions : {&state_.position, &next_position_}) {
    (*positions)[particle] = place;
  }
  for (auto* velocities : {&state_.velocity, &next_velocity_}) {
    (*velocities)[particle] = {0, 0, 0, (*velocities)[particle].w};
  }
  if (!state_.remainder.empty()) {
    state_.remainder[particle] = {};
  }
  stones_.lookAgain();
}

bool Bed::hasRoomFor(std::size_t particle, const Vec3& place_m) const noexcept {
  HAPTO_ASSERT(particle < particles());
  const double radius_m = parameters_.soil.radius_m + static_cast<double>(state_.position[particle].w);
  const double highest_m = grid_height_m_ + 1;
  if (!place_m.allFinite() || std::abs(place_m.x()) > static_cast<double>(box_.half_width) - radius_m ||
      std::abs(place_m.y()) > static_cast<double>(box_.half_length) - radius_m || place_m.z() < radius_m ||
      place_m.z() > highest_m || stones_.depthOf(place_m, radius_m) > 0) {
    return false;
  }
  const double reach_m = radius_m + parameters_.soil.radius_m + largestExcess(parameters_.soil) + skin_m_ / 2;
  const auto corner = [&](double sign) {
    return Float4{narrow<float>(place_m.x() + sign * reach_m), narrow<float>(place_m.y() + sign * reach_m),
                  narrow<float>(place_m.z() + sign * reach_m), 0};
  };
  bool room = true;
  neighbourhood_.forEachIn(neighbourhood_.placeOf(corner(-1), corner(1)), [&](std::int32_t other) {
    const Float4& at = state_.position[static_cast<std::size_t>(other)];
    const double apart_m = (Vec3(at.x, at.y, at.z) - place_m).norm();
    room = room && (static_cast<std::size_t>(other) == particle ||
                    apart_m >= radius_m + parameters_.soil.radius_m + static_cast<double>(at.w));
  });
  return room;
}

bool Bed::moveGrain(const GrainMove& move) noexcept {
  constexpr double kStillThere = 0.1;  // in R
  if (move.grain >= particles() || isDriven(move.grain)) {
    return false;
  }
  const Float4& at = state_.position[move.grain];
  const bool there = (Vec3(at.x, at.y, at.z) - move.from_m).norm() <= kStillThere * parameters_.soil.radius_m;
  if (!there || !hasRoomFor(move.grain, move.to_m)) {
    return false;
  }
  place(move.grain, move.to_m);
  return true;
}

std::uint64_t Bed::hash(std::span<const ToolTrace> tools, std::size_t part, std::size_t parts) const noexcept {
  HAPTO_ASSERT(part < parts);
  return stonesHash(stones_.state(), stateHash(state_, tools, part, parts));
}

Vec3 Bed::contactForce(std::size_t particle) const noexcept {
  HAPTO_ASSERT(particle < particles());
  const Float4& force = contact_force_[particle];
  return {force.x, force.y, force.z};
}

double Bed::largestSpeed(std::size_t first, std::size_t last) const noexcept {
  HAPTO_ASSERT(first <= last && last <= particles());
  float largest = 0;
  for (std::size_t i = first; i < last; ++i) {
    if (state_.asleep(i / kGroup)) {
      i += kGroup - 1 - i % kGroup;
      continue;
    }
    const Float4& v = state_.velocity[i];
    largest = v.w == 0 ? std::max(largest, v.x * v.x + v.y * v.y + v.z * v.z) : largest;
  }
  return std::sqrt(largest);
}

double Bed::surfaceHeight() const noexcept {
  float highest = 0;
  for (std::size_t i = 0; i < particles(); ++i) {
    highest = std::max(highest, state_.position[i].z + state_.position[i].w);
  }
  return highest + parameters_.soil.radius_m;
}

double Bed::takeListRebuildUs() noexcept {
  return 1e-3 * static_cast<double>(std::exchange(rebuilding_ns_, 0));
}

std::size_t Bed::bytes() const noexcept {
  const std::size_t records = state_.position.size() + state_.velocity.size() + state_.reference_position.size() +
                              next_position_.size() + next_velocity_.size() + external_.size() + contact_force_.size() +
                              state_.rested_at.size() + state_.remainder.size();
  return records * sizeof(Float4) + state_.wall_slip.size() * (sizeof(WallSlips) + 1) + is_pushed_.size() +
         moved_.size() * sizeof(moved_[0]) + state_.rested.size() * sizeof(state_.rested[0]) + wakefulness_.bytes() +
         changed_.size() * sizeof(changed_[0]) + state_.contacts.bytes() + neighbourhood_.bytes() + stones_.bytes();
}

}  // namespace haptolith

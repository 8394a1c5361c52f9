#include "haptolith/bed/bed.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <tuple>
#include <utility>

#include "haptolith/bed/bed_start.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/bed/graded_start.h"
#include "haptolith/bed/spatial_order.h"
#include "haptolith/bed/tile_cache.h"
#include "haptolith/core/clock.h"
#include "haptolith/core/error.h"
#include "haptolith/core/random.h"

namespace haptolith {

namespace {

/// Extra reach of the neighbour lists in radii. Larger: longer lists for every step; smaller: particles that move have
/// to be entered again more often. At 0.5 the next shell of a close packing (2 sqrt(2) R) stays just outside.
constexpr double kSkinRadii = 0.5;

/// Neighbours further apart than a contact reaches and this besides, in radii, are not near, and as long as none has
/// gone half as far, they do not touch: the rows that hold nobody else are left out (NearRows). Larger: more rows for
/// every step; smaller: more looks.
constexpr double kNearRadii = 0.1;

constexpr std::size_t kBits = 64;  // of a word

/// A thread is worth waking, which takes some 100 us, for at least this many particles; contacts with friction take
/// three times as long as the paper's, and several substeps a tick. Where two threads begin to be faster than one in
/// `haptolith bench` on two cores, to a power of two.
std::size_t particlesPerThread(FrictionModel friction) {
  return friction == FrictionModel::kContact ? 512 : 4096;
}

/// Simulated time after which falling particles that still move are given up: they calm down within a minute, and sink
/// for as long as the deep ones among them take, with a margin.
double longestSettling(const BedParameters& bed, double height_m, double dt_s) {
  return 60 + 3 * sinkingTime(bed.soil, bed.gravity_m_s2.norm(), height_m, dt_s);
}

/// For so long, about, nothing must have stirred: counted in steps of the bed alone, which a tool may make shorter.
constexpr double kRest_s = 0.1;
/// What has gone further than it goes at the speed of rest in this time has stirred, however slowly it went.
constexpr double kCreep_s = 0.02;

RestRule restRule(const BedParameters& bed) {
  const double dt_s = std::min(bed.tick_s, 1 / stepsPerSecond(finestSoil(bed), 0));
  const auto speed = static_cast<float>(bed.sleep_speed_m_s);
  return {.sleep = bed.sleep,
          .speed_m_s = speed,
          .distance_m = speed * static_cast<float>(kCreep_s),
          .steps = static_cast<std::uint16_t>(std::clamp(kRest_s / dt_s, double{Wakefulness::kTurn}, 60'000.0))};
}

/// With contact friction only contacts damp; soil that falls, or slides to the walls when it is laid, comes to rest
/// sooner in something thicker than space: a drag that stops free movement within some 0.2 s and lets soil fall at
/// g / 5 s. Soil at rest does not feel it.
constexpr float kSettlingDrag_per_s = 5;

/// Lets wrong parameters go no further than the first member that would be made of them.
const BedParameters& validated(const BedParameters& parameters) {
  validate(parameters);
  return parameters;
}

int usefulThreads(const BedParameters& bed, std::size_t particles) {
  return std::clamp(static_cast<int>(particles / particlesPerThread(bed.soil.friction)), 1, bed.threads);
}

/// A loop is shared out in so many parts that a thread whose core is taken away holds up the others by little.
int mostParts(int threads) {
  constexpr int kPartsPerThread = 32;
  return threads == 1 ? 1 : kPartsPerThread * threads;
}

/// Parts for so many groups: none so small that taking it costs more than a few hundredths of it.
int partsFor(const BedParameters& bed, std::size_t groups, int threads) {
  constexpr std::size_t kGroupsPerPart = 8;
  return usefulThreads(bed, groups * kGroup) == 1
             ? 1
             : std::clamp(static_cast<int>(groups / kGroupsPerPart), 1, mostParts(threads));
}

/// How much the largest particle's radius exceeds the mean, in m, in the coarsest class.
double largestExcess(const SoilParameters& soil) {
  return soil.friction == FrictionModel::kContact ? soil.size_spread * soil.radius_m : 0;
}

template <class To, class From>
To narrow(From value) noexcept {
  return static_cast<To>(value);
}

StepBox stepBox(const BedParameters& bed) {
  return {.half_width = narrow<float>(bed.width_m / 2),
          .half_length = narrow<float>(bed.length_m / 2),
          .walls_x = !bed.periodic_x,
          .walls_y = !bed.periodic_y,
          .wall_ratio = narrow<float>(bed.wall_friction_ratio),
          .periods = periodsOf(bed)};
}

double highest(const std::vector<Float4>& grains) {
  float height = 0;
  for (const Float4& grain : grains) {
    height = std::max(height, grain.z);
  }
  return height;
}

/// Centres with sizes as the seed deals them out.
std::vector<Float4> withSizes(const BedParameters& bed, const std::vector<Vec3>& centres_m) {
  std::mt19937_64 random(bed.seed);
  std::vector<Float4> grains;
  grains.reserve(centres_m.size());
  for (const Vec3& centre : centres_m) {
    const double excess = largestExcess(bed.soil) * uniformSigned(random);
    grains.push_back(
        {narrow<float>(centre.x()), narrow<float>(centre.y()), narrow<float>(centre.z()), narrow<float>(excess)});
  }
  return grains;
}

/// While laid soil finds its hold at the walls, what moves no faster is at rest. The further from the middle, the more
/// a position is rounded (0.2 um at 2 m) and the more soil shivers: with 1e-3 m/s a million of lunar-0-15cm wakes from
/// wall to wall.
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

bool isZero(const Float4& a) {
  return a.x == 0 && a.y == 0 && a.z == 0;
}

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
      of_other_size |= bed.classOf(narrow<std::size_t>(lists.neighbour(i, s))) != bed.classOf(i);
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
    return std::vector<Float4>(position.begin(), position.begin() + narrow<std::ptrdiff_t>(made.particles()));
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

/// Groups first..last-1 of a part of the work.
struct GroupRange {
  std::size_t first, last;
};
GroupRange groupsOf(int part, int parts, std::size_t groups) {
  const auto share = [&](int p) { return groups * static_cast<std::size_t>(p) / static_cast<std::size_t>(parts); };
  return {share(part), share(part + 1)};
}

/// Whether two lists name the same neighbours, in whatever order.
bool sameNeighbours(const ContactLists& a, const ContactLists& b, std::size_t i) {
  const auto named = [i](const ContactLists& lists) {
    std::vector<std::int32_t> names;
    for (std::uint32_t s = 0; s < lists.count(i); ++s) {
      names.push_back(lists.neighbour(i, s));
    }
    std::ranges::sort(names);
    return names;
  };
  return named(a) == named(b);
}

}  // namespace

const char* text(StepStatus status) noexcept {
  switch (status) {
    case StepStatus::kOk: return "ok";
    case StepStatus::kNotFinite: return "a position or velocity is no longer a number";
    case StepStatus::kCollapsed: return "the bed has collapsed onto itself: too many particles in one place";
  }
  return "";
}

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

Bed::Bed(const BedParameters& parameters, const std::vector<Vec3>& centres_m)
    : Bed(parameters, withSizes(validated(parameters), centres_m)) {}

Bed::Bed(const BedParameters& parameters, const std::vector<Float4>& grains)
    : parameters_(validated(parameters)),
      laws_(parameters.soil, grainClasses(parameters)),
      box_(stepBox(parameters)),
      skin_m_(narrow<float>(kSkinRadii * parameters.soil.radius_m)),
      neighbourhood_(grains.size(),
                     {.classes = laws_.graded.classes,
                      .reach_m = laws_.pair.cutoff_m + skin_m_,
                      .beyond_m = laws_.pair.cutoff_m + skin_m_ - laws_.pair.diameter_m,
                      .largest_excess_m = largestExcess(parameters.soil)},
                     {parameters.width_m, parameters.length_m, highest(grains), periodsOf(parameters)}),
      wakefulness_(paddedCount(grains.size()) / kGroup, restRule(parameters)),
      team_(usefulThreads(parameters, grains.size())),
      moved_of_part_(static_cast<std::size_t>(mostParts(team_.size()))) {
  found_by_part_.resize(moved_of_part_.size());
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
  state_.tool_side.resize(n);
  noteClasses();
  state_.listed_at = state_.position;
  state_.rested.resize(padded / kGroup);
  state_.rested_at = state_.position;
  state_.contacts = ContactLists(n, hasContactFriction());
  next_velocity_ = state_.velocity;
  next_position_ = state_.position;
  external_.resize(padded);
  contact_force_.resize(padded);
  moved_.resize(padded);
  near_now_.resize(padded / kGroup / kBits + 1);
  near_before_ = near_now_;
  near_groups_.reserve(padded / kGroup);
  if (hasContactFriction()) {
    state_.wall_slip.resize(padded / kGroup);
    near_walls_.resize(padded / kGroup);
    state_.tool_slip.resize(n);
  }
  if (!neighbourhood_.enterAll(state_.listed_at, state_.contacts)) {
    throw InvalidParameter("centres_m", fmt::format("{} particles", n), "apart from each other");
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
  now_ = constantsFor(dt_s);
  wakefulness_.listAwake();  // somebody may have been woken since the last step
  parts_ = partsFor(parameters_, wakefulness_.awake().size(), team_.size());
  team_.run([](void* bed, int part, int parts) noexcept { static_cast<Bed*>(bed)->stepPart(part, parts); }, this,
            parts_);
  state_.position.swap(next_position_);
  state_.velocity.swap(next_velocity_);
  ++state_.step;
  for (const Moved& moved : movedOfParts()) {
    if (!moved.finite) {
      return StepStatus::kNotFinite;
    }
  }
  lookAgainWhenGoneFar(dt_s);
  if (!relistMovedParticles()) {
    return StepStatus::kCollapsed;
  }
  wakeAndLetSleep();
  return StepStatus::kOk;
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
          .look = look_,
          .near_m = narrow<float>(kNearRadii * GrainClasses::scale(classes().count() - 1) * soil.radius_m),
          // c = k dt / 2 for each contact (paper 20), with the step that is really taken
          .damping = narrow<float>(soil.stiffness_n_m * dt_s / 2),
          .static_friction = narrow<float>(mu_hat),
          .moving_friction = narrow<float>(mu_hat * soil.moving_friction_ratio),
          .friction_ratio = friction_on_ ? 1.0F : 0.0F,
          .drag = friction_on_ && !laying_ ? 1 : 1 / (1 + kSettlingDrag_per_s * narrow<float>(dt_s))};
}

std::span<const std::uint32_t> Bed::groupsNear(const Vec3& centre_m, double radius_m) noexcept {
  const double reach = radius_m + skin_m_ / 2;  // particles are not further from their places in the grid
  const auto corner = [&](double sign) {
    return Float4{narrow<float>(centre_m.x() + sign * reach), narrow<float>(centre_m.y() + sign * reach),
                  narrow<float>(centre_m.z() + sign * reach), 0};
  };
  std::ranges::fill(near_now_, std::uint64_t{0});
  neighbourhood_.forEachNear(corner(-1), corner(1), [&](std::int32_t particle) {
    const std::size_t group = static_cast<std::size_t>(particle) / kGroup;
    near_now_[group / kBits] |= std::uint64_t{1} << (group % kBits);
  });
  near_groups_.clear();
  for (std::size_t word = 0; word < near_now_.size(); ++word) {
    for (std::uint64_t bits = near_now_[word] | near_before_[word]; bits != 0; bits &= bits - 1) {
      near_groups_.push_back(narrow<std::uint32_t>(word * kBits + static_cast<std::size_t>(std::countr_zero(bits))));
    }
  }
  near_now_.swap(near_before_);
  for (const std::uint32_t group : near_groups_) {
    wakefulness_.wake(group, state_);
  }
  return near_groups_;
}

void Bed::stepPart(int part, int parts) noexcept {
  const auto [first, last] = groupsOf(part, parts, wakefulness_.awake().size());
  const StepArrays arrays{.groups = wakefulness_.awake().data(),
                          .moving = wakefulness_.moving(),
                          .position = state_.position.data(),
                          .velocity = state_.velocity.data(),
                          .external = external_.data(),
                          .listed_at = state_.listed_at.data(),
                          .next_position = next_position_.data(),
                          .next_velocity = next_velocity_.data(),
                          .contact_force = driven_ > 0 ? contact_force_.data() : nullptr,
                          .wall_slip = state_.wall_slip.data(),
                          .grain_class = grain_class_.empty() ? nullptr : grain_class_.data(),
                          .near_walls = near_walls_.data(),
                          .other = state_.contacts.others(),
                          .slip = state_.contacts.slips(),
                          .first_row = state_.contacts.firstRows(),
                          .rows = state_.contacts.rowCounts(),
                          .touched = state_.contacts.touchedRows(),
                          .near = state_.contacts.nearRows()};
  Moved moved{moved_.data() + first * kGroup};
  if (hasContactFriction()) {
    stepWithContactFriction(laws_.graded, now_, box_, arrays, first, last, moved);
  } else {
    stepWithPaperFriction(laws_.kernel, now_, box_, arrays, first, last, moved);
  }
  moved_of_part_[static_cast<std::size_t>(part)] = moved;
  found_by_part_[static_cast<std::size_t>(part)] = wakefulness_.count(first, last, next_position_, state_);
}

void Bed::lookAgainWhenGoneFar(double dt_s) noexcept {
  constexpr double kRounded = 0.98;  // of the way: positions and distances are rounded
  float fastest_squared = 0;
  for (const Moved& moved : movedOfParts()) {
    fastest_squared = std::max(fastest_squared, moved.fastest_squared);
  }
  gone_since_look_m_ += std::sqrt(double{fastest_squared}) * dt_s;
  if (gone_since_look_m_ > kRounded * now_.near_m / 2) {
    ++look_;
    gone_since_look_m_ = 0;
  }
}

bool Bed::relistMovedParticles() noexcept {
  std::size_t count = 0;  // close the gaps between the parts
  for (const Moved& moved : movedOfParts()) {
    std::copy_n(moved.particle, moved.count, moved_.data() + count);
    count += moved.count;
  }
  if (count == 0) {
    return true;
  }
  relistings_ += count;
  const std::int64_t start_ns = monotonicNs();
  const bool fits =
      neighbourhood_.enterAgain({moved_.data(), count}, state_.position, state_.listed_at, state_.contacts);
  for (std::size_t k = 0; k < count; ++k) {
    wakefulness_.wakeAround(static_cast<std::size_t>(moved_[k]), state_);  // they may have new neighbours
  }
  relisting_ns_ += monotonicNs() - start_ns;
  return fits;
}

void Bed::wakeAndLetSleep() noexcept {
  for (const Wakefulness::Found& found : foundByParts()) {
    wakefulness_.wakeBeside({found.disturbed, found.disturbed_count}, state_);
  }
  for (const Wakefulness::Found& found : foundByParts()) {
    wakefulness_.putToSleep({found.ready_to_sleep, found.ready_to_sleep_count}, near_before_,
                            {.state = state_, .next_position = next_position_, .next_velocity = next_velocity_});
  }
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
  }
  parameters_.gravity_m_s2 = gravity_m_s2;
}

void Bed::setSoil(const SoilLaws& laws) noexcept {
  wakefulness_.wakeAll(state_);
  parameters_.soil = laws.soil;
  laws_ = laws;
  ++look_;  // its contacts may reach further
}

void Bed::drive(std::size_t particle, const Vec3& velocity_m_s) noexcept {
  driven_ += isDriven(particle) ? 0 : 1;
  wake(particle);
  state_.velocity[particle] = {narrow<float>(velocity_m_s.x()), narrow<float>(velocity_m_s.y()),
                               narrow<float>(velocity_m_s.z()), 1};
}

void Bed::release(std::size_t particle) noexcept {
  driven_ -= isDriven(particle) ? 1 : 0;
  wake(particle);
  state_.velocity[particle].w = 0;
}

Vec3 Bed::contactForce(std::size_t particle) const noexcept {
  const Float4& force = contact_force_[particle];
  return {force.x, force.y, force.z};
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
      const std::uint32_t other = soil.laid.sources[narrow<std::size_t>(state_.contacts.neighbour(i, s))];
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
    const auto first = state_.position.begin() + narrow<std::ptrdiff_t>(group * kGroup);
    state_.rested[group] = upright && std::all_of(first, first + narrow<std::ptrdiff_t>(kGroup), inside)
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
  const bool sleeps = own.sleep && own.speed_m_s >= narrow<float>(kStartsAsleep_m_s);
  std::ranges::fill(state_.rested, sleeps ? BedState::kAsleep : std::uint16_t{0});
  state_.rested_at = state_.position;
  wakefulness_.setRule(own);
  wakefulness_.takeOver(state_);
  wakefulness_.listAwake();
  state_.step = 0;
}

double Bed::energy() const {
  double energy = 0;
  const std::size_t n = particles();
  const auto at = [this](std::size_t i) {
    const Float4& p = state_.position[i];
    return Vec3(p.x, p.y, p.z);
  };
  const auto cohering = [this](ContactLaw law, double ratio) {
    law.cohesion_n *= (friction_on_ ? 1 : 0) * ratio;
    return law;
  };
  const int classes = this->classes().count();
  const auto index = [classes](int a, int b) {
    return static_cast<std::size_t>(classes) * static_cast<std::size_t>(a) + static_cast<std::size_t>(b);
  };
  std::vector<ContactLaw> pairs;
  for (int k = 0; k < classes * classes; ++k) {
    const ContactLaw law =
        classes == 1 ? laws_.pair : makeContactLaw(soilBetween(parameters_.soil, k / classes, k % classes));
    pairs.push_back(cohering(law, 1));
  }
  const auto law_between = [&](int a, int b) -> const ContactFrictionLaw& {
    return laws_.graded.between[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 x = at(i);
    const Float4& v = state_.velocity[i];
    const int own = classOf(i);
    const double mass_kg = laws_.mass_kg * GrainClasses::scale(3 * own);
    energy += mass_kg / 2 * Vec3(v.x, v.y, v.z).squaredNorm() - mass_kg * parameters_.gravity_m_s2.dot(x);
    // Half of a pair's: the mirror image moves as far as the particle.
    const double radius_m = GrainClasses::scale(own) * parameters_.soil.radius_m;
    const ContactLaw floor = wallLaw(pairs[index(own, own)], radius_m);
    ContactLaw side_wall = floor;
    side_wall.cohesion_n *= parameters_.wall_friction_ratio;
    const double excess = state_.position[i].w;
    const double nearer = law_between(own, own).nearer;
    const auto to_walls = [&](double across_m, double from_middle_m) {
      return contactEnergy(side_wall, across_m - 2 * (std::abs(from_middle_m) + excess) - nearer) / 2;
    };
    energy += contactEnergy(floor, 2 * (x.z() - excess) - nearer) / 2;
    energy += parameters_.periodic_x ? 0 : to_walls(parameters_.width_m, x.x());
    energy += parameters_.periodic_y ? 0 : to_walls(parameters_.length_m, x.y());
    for (std::uint32_t s = 0; s < state_.contacts.count(i); ++s) {
      const auto j = static_cast<std::size_t>(state_.contacts.neighbour(i, s));
      if (j > i) {
        Vec3 apart = x - at(j);
        apart.x() -= box_.periods.width * std::round(apart.x() * box_.periods.per_width);
        apart.y() -= box_.periods.length * std::round(apart.y() * box_.periods.per_length);
        const int other = classOf(j);
        const ContactFrictionLaw& law = law_between(own, other);
        energy += contactEnergy(pairs[index(own, other)], apart.norm() - excess - state_.position[j].w - law.nearer);
        if (hasContactFriction()) {  // of the side that is awake
          const bool other_side = state_.rested[i / kGroup] == BedState::kAsleep;
          const Slip slip = other_side ? state_.contacts.slip(j, state_.contacts.find(j, narrow<std::int32_t>(i)))
                                       : state_.contacts.slip(i, s);
          energy += law.stiffness / 2 * Vec3(slip.x, slip.y, slip.z).squaredNorm();
        }
      }
    }
    if (hasContactFriction()) {
      const WallSlips& slips = state_.wall_slip[i / kGroup];
      for (const auto* slip :
           {&slips.floor_x, &slips.floor_y, &slips.x_wall_y, &slips.x_wall_z, &slips.y_wall_x, &slips.y_wall_z}) {
        const float slid = (*slip)[i % kGroup];
        energy += law_between(own, own).stiffness / 2 * slid * slid;
      }
    }
  }
  return energy;
}

double Bed::largestSpeed(std::size_t first, std::size_t last) const noexcept {
  float largest = 0;
  for (std::size_t i = first; i < last; ++i) {
    if (state_.rested[i / kGroup] == BedState::kAsleep) {
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

double Bed::takeRelistingUs() noexcept {
  return 1e-3 * static_cast<double>(std::exchange(relisting_ns_, 0));
}

std::size_t Bed::bytes() const noexcept {
  const std::size_t records = state_.position.size() + state_.velocity.size() + state_.listed_at.size() +
                              next_position_.size() + next_velocity_.size() + external_.size() + contact_force_.size() +
                              state_.rested_at.size() + state_.tool_slip.size();
  return records * sizeof(Float4) + state_.wall_slip.size() * (sizeof(WallSlips) + 1) + state_.tool_side.size() +
         moved_.size() * sizeof(moved_[0]) + state_.rested.size() * sizeof(state_.rested[0]) + wakefulness_.bytes() +
         state_.contacts.bytes() + neighbourhood_.bytes();
}

void Bed::restore(const BedState& state) {
  const std::size_t n = particles();
  const std::size_t records = paddedCount(n);
  if (state.particles() != n || state.position.size() != records || state.velocity.size() != records ||
      state.listed_at.size() != records || state.rested_at.size() != records ||
      state.rested.size() != records / kGroup || state.contacts.particles() != n) {
    throw InvalidParameter("state", fmt::format("{} particles", state.particles()),
                           fmt::format("of this bed's {} particles", n));
  }
  // A saved state may come from a file: a position that is NaN would become the index of a cell.
  const auto finite = [](float value) { return std::isfinite(value); };
  const auto is_number = [&](const Float4& r) { return finite(r.x) && finite(r.y) && finite(r.z) && finite(r.w); };
  for (const auto* records_of :
       {&state.position, &state.velocity, &state.listed_at, &state.rested_at, &state.tool_slip}) {
    if (!std::all_of(records_of->begin(), records_of->end(), is_number)) {
      throw InvalidParameter("state", "positions, velocities or slips that are no numbers", "finite");
    }
  }
  // The neighbour lists reach as far as the largest particles of this soil do, and groups keep their class.
  const auto fitting = [&](const Float4& p) {
    const double scale = GrainClasses::scale(classes().of(p.w));
    const double mean_m = (scale - 1) * parameters_.soil.radius_m;
    constexpr float kRounding = 1e-6F;
    return std::abs(p.w - narrow<float>(mean_m)) <=
           narrow<float>(scale * largestExcess(parameters_.soil)) + kRounding * std::abs(p.w) * (scale < 1 ? 1 : 0);
  };
  for (const auto* records_of : {&state.position, &state.listed_at}) {
    if (!std::all_of(records_of->begin(), records_of->end(), fitting)) {
      throw InvalidParameter("state", "particles of other sizes", "of this bed's size_spread and grading");
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (classes().of(state.position[i].w) != classOf(i) || classes().of(state.listed_at[i].w) != classOf(i)) {
      throw InvalidParameter("state", "grains of other classes", "of this bed's classes, grain by grain");
    }
  }
  if (state.contacts.remembers() != hasContactFriction() ||
      state.wall_slip.size() != (hasContactFriction() ? records / kGroup : 0) ||
      state.tool_slip.size() != (hasContactFriction() ? n : 0)) {
    throw InvalidParameter("state", hasContactFriction() ? "without a memory of friction" : "with a memory of friction",
                           "of a bed with this bed's friction");
  }
  bool numbers = true;
  for (const WallSlips& slips : state.wall_slip) {
    for (const auto* slip :
         {&slips.floor_x, &slips.floor_y, &slips.x_wall_y, &slips.x_wall_z, &slips.y_wall_x, &slips.y_wall_z}) {
      numbers = numbers && std::ranges::all_of(*slip, finite);
    }
  }
  for (std::size_t i = 0; hasContactFriction() && i < n; ++i) {
    for (std::uint32_t s = 0; s < state.contacts.count(i); ++s) {
      const Slip slip = state.contacts.slip(i, s);
      numbers = numbers && finite(slip.x) && finite(slip.y) && finite(slip.z);
    }
  }
  if (!numbers) {
    throw InvalidParameter("state", "a contact's slip that is NaN or infinite", "finite");
  }
  // Its lists must be those of its places; their order, which is the order of sums, is its own.
  ContactLists listed(n, hasContactFriction());
  const bool entered = neighbourhood_.enterAll(state.listed_at, listed);
  bool fits = entered;
  for (std::size_t i = 0; fits && i < n; ++i) {
    fits = sameNeighbours(listed, state.contacts, i);
  }
  if (!fits) {
    ContactLists own(n, hasContactFriction());
    (void)neighbourhood_.enterAll(state_.listed_at, own);  // the grid; it fitted when it was made
    throw InvalidParameter("state",
                           entered ? "neighbours that do not fit its places" : "a bed that has collapsed onto itself",
                           entered ? "as it was saved" : "particles apart from each other");
  }
  state_.step = state.step;  // piece by piece: what is reserved stays reserved
  state_.position = state.position;
  state_.velocity = state.velocity;
  state_.listed_at = state.listed_at;
  state_.rested = state.rested;
  state_.rested_at = state.rested_at;
  state_.tool_side = state.tool_side;
  state_.wall_slip = state.wall_slip;
  std::ranges::fill(near_walls_, std::uint8_t{0xFF});
  state_.tool_slip = state.tool_slip;
  state_.contacts.takeOver(state.contacts);
  driven_ = 0;
  std::ranges::fill(external_, Float4{});
  std::ranges::fill(near_before_, std::uint64_t{0});
  for (std::size_t i = 0; i < n; ++i) {
    driven_ += isDriven(i) ? 1 : 0;
    const bool touched = state.tool_side[i] != 0 || (hasContactFriction() && !isZero(state.tool_slip[i]));
    near_before_[i / kGroup / kBits] |= std::uint64_t{touched} << (i / kGroup % kBits);  // the tool was there
  }
  std::fill(state_.position.begin() + narrow<std::ptrdiff_t>(n), state_.position.end(), kGhost);
  std::fill(state_.listed_at.begin() + narrow<std::ptrdiff_t>(n), state_.listed_at.end(), kGhost);
  std::fill(state_.velocity.begin() + narrow<std::ptrdiff_t>(n), state_.velocity.end(), kGhostVelocity);
  next_position_ = state_.position;  // who sleeps stands in both
  next_velocity_ = state_.velocity;
  wakefulness_.takeOver(state_);
}

}  // namespace haptolith

#include "haptolith/bed/bed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "haptolith/bed/bed_start.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/bed/friction-inl.h"
#include "haptolith/core/error.h"
#include "haptolith/core/random.h"
#include "haptolith/soil/contact_law-inl.h"

namespace haptolith {

namespace {

/// Extra reach of the neighbour list in radii. Larger: longer lists for every step; smaller: more rebuilds while
/// digging. At 0.5 the next shell of a close packing (2 sqrt(2) R) stays just outside, so most particles need one block
/// only.
constexpr double kSkinRadii = 0.5;

/// A thread is worth waking for at least this many particles.
constexpr std::size_t kParticlesPerThread = 512;

/// Simulated time after which falling particles that still move are given up. Free fall takes a second or two, but once
/// they touch, damping (paper 20) lets them sink at no more than 2 m g / (p k dt), p = 12, and a deep bed sinks far.
double longestSettling(const BedParameters& bed, double height_m, double dt_s) {
  constexpr double kCalmingDown_s = 60;
  constexpr double kMargin = 3;
  const double sinking_m_s =
      2 * macroparticleMass(bed.soil) * bed.gravity_m_s2.norm() / (12 * bed.soil.stiffness_n_m * dt_s);
  return kCalmingDown_s + (sinking_m_s > 0 ? kMargin * height_m / sinking_m_s : 0);
}

/// With pairwise friction only contacts damp; falling soil comes to rest sooner in something thicker than space. Has no
/// say in where it rests.
constexpr float kSettlingDrag_per_s = 5;

constexpr Float4 kGhost{1e9F, 1e9F, 1e9F, 0};

/// Lets wrong parameters go no further than the first member that would be made of them.
const BedParameters& validated(const BedParameters& parameters) {
  validate(parameters);
  return parameters;
}

int usefulThreads(int wanted, std::size_t particles) {
  return std::clamp(static_cast<int>(particles / kParticlesPerThread), 1, wanted);
}

/// How much the largest particle's radius exceeds the mean, in m.
double largestExcess(const SoilParameters& soil) {
  return soil.friction == FrictionModel::kPairwise ? soil.size_spread * soil.radius_m : 0;
}

Periods periodsOf(const BedParameters& bed) {
  Periods periods;
  if (bed.periodic_x) {
    periods.width = static_cast<float>(bed.width_m);
    periods.per_width = 1 / periods.width;
  }
  if (bed.periodic_y) {
    periods.length = static_cast<float>(bed.length_m);
    periods.per_length = 1 / periods.length;
  }
  return periods;
}

template <class To, class From>
To narrow(From value) noexcept {
  return static_cast<To>(value);
}

/// A particle on its way through advance(): forces gathered so far, besides those of other particles.
struct Load {
  float x, y, z;
  float repulsion;
  float contacts;
};

/// Adds the push of a wall at `distance` along one axis; `sign` is the axis's direction away from the wall. The wall is
/// the particle's mirror image (see wallLaw()) and, like any macroparticle, counts for friction and damping.
inline void addWall(const KernelLaw& law, float distance, float sign, float& force, Load& load) noexcept {
  const float a = 2 * distance;
  if (a < law.diameter) {
    const HWY_NAMESPACE::LawOf<float> constants{law.gamma, law.a_min, law.a_thr, law.h, law.k};
    const float push = HWY_NAMESPACE::uncutContactForce(constants, a);
    force += sign * push;
    load.repulsion += push;
    load.contacts += 1;
  }
}

/// A particle against a wall with pairwise friction: `distance` to it, velocity away from it and along it.
struct WallTouch {
  float distance, away, along_1, along_2;
};
struct WallForce {
  float away = 0, along_1 = 0, along_2 = 0;
};

/// The wall is the particle's mirror image, which comes as fast as it goes, and does not slide; `ratio` is its
/// friction and cohesion over the soil's. The slip so far is read and written.
WallForce wallForce(const PairwiseLaw& soil, float dt, float ratio, const WallTouch& touch, float& slip_1,
                    float& slip_2) noexcept {
  namespace law = HWY_NAMESPACE;
  const float a = 2 * touch.distance;
  if (a >= soil.normal.cutoff) {
    slip_1 = slip_2 = 0;
    return {};
  }
  const law::LawOf<float> normal{soil.normal.gamma, soil.normal.a_min, soil.normal.a_thr, soil.normal.h, soil.normal.k};
  const law::CohesionOf<float> cohesion{ratio * soil.cohesion, soil.two_per_range, 0, 1};
  const law::FrictionOf<float> friction{dt, soil.stiffness, soil.tangential_damping, 0, 1, 1e-20F};
  const law::CohesiveContact<float> contact = law::cohesiveContact(normal, cohesion, soil.normal.diameter, a);
  const float damped =
      contact.normal - soil.damping * law::rootOfStiffness(normal, soil.root_of_gamma, a) * 2 * touch.away;
  law::Triple<float> slip{slip_1, slip_2, 0};
  const law::Triple<float> drag = law::frictionForce<float>(friction, ratio * soil.friction * contact.compression,
                                                            {0, 0, 1}, {touch.along_1, touch.along_2, 0}, slip);
  slip_1 = slip.x;
  slip_2 = slip.y;
  return {std::max(damped, std::min(contact.normal, 0.0F)), drag.x, drag.y};
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
    : Bed(parameters, startingCentres(parameters)) {
  if (parameters.start == BedStart::kRain) {
    const int substeps = substepsFor(parameters.soil, 0, parameters.tick_s, parameters.max_substeps);
    const double dt_s = parameters.tick_s / substeps;
    settle(dt_s, longestSettling(parameters, surfaceHeight(), dt_s), progress);
  }
}

Bed::Bed(const BedParameters& parameters, const std::vector<Vec3>& centres_m)
    : parameters_(validated(parameters)),
      law_(makeContactLaw(parameters.soil)),
      wall_law_(wallLaw(law_, parameters.soil.radius_m)),
      kernel_law_(kernelLaw(law_, parameters.soil.radius_m)),
      pairwise_law_(pairwiseLaw(parameters.soil)),
      periods_(periodsOf(parameters)),
      mass_kg_(macroparticleMass(parameters.soil)),
      skin_m_(narrow<float>(kSkinRadii * parameters.soil.radius_m)),
      neighbours_(centres_m.size(), law_.cutoff_m + 2 * largestExcess(parameters.soil) + skin_m_, parameters.width_m,
                  parameters.length_m, periods_),
      team_(usefulThreads(parameters.threads, centres_m.size())),
      part_results_(static_cast<std::size_t>(team_.size())) {
  const std::size_t n = centres_m.size();
  std::mt19937_64 random(parameters.seed);
  for (const Vec3& centre : centres_m) {
    const double excess = largestExcess(parameters.soil) * evenly(random);
    if (!centre.cast<float>().allFinite()) {
      throw InvalidParameter("centres_m", fmt::format("{} {} {}", centre.x(), centre.y(), centre.z()), "finite");
    }
    state_.position.push_back(
        {narrow<float>(centre.x()), narrow<float>(centre.y()), narrow<float>(centre.z()), narrow<float>(excess)});
  }
  state_.position.push_back(kGhost);
  state_.velocity.resize(n + 1);
  next_velocity_ = state_.velocity;
  state_.tool_side.resize(n);
  state_.listed_at = state_.position;
  next_position_ = state_.position;
  external_.resize(n);
  sums_.resize(n);
  if (isPairwise()) {
    for (FloatArray* slip :
         {&state_.slip_x, &state_.slip_y, &state_.slip_z, &next_slip_x_, &next_slip_y_, &next_slip_z_}) {
      slip->reserve(neighbours_.capacity());
    }
    state_.wall_slip.resize(n);
    state_.tool_slip.resize(n);
  }
  if (!rebuildNeighbours()) {
    throw InvalidParameter("centres_m", fmt::format("{} particles", n), "apart from each other");
  }
}

StepStatus Bed::step(double dt_s) noexcept {
  now_ = constantsFor(dt_s);
  team_.run([](void* bed, int part, int parts) noexcept { static_cast<Bed*>(bed)->advancePart(part, parts); }, this);
  state_.position.swap(next_position_);
  state_.velocity.swap(next_velocity_);
  ++state_.step;

  bool moved_far = false;
  for (const Part& part : part_results_) {
    if (!part.finite) {
      return StepStatus::kNotFinite;
    }
    moved_far = moved_far || part.moved_far;
  }
  return !moved_far || rebuildNeighbours() ? StepStatus::kOk : StepStatus::kCollapsed;
}

Bed::StepConstants Bed::constantsFor(double dt_s) const noexcept {
  const SoilParameters& soil = parameters_.soil;
  const Vec3 weight = mass_kg_ * parameters_.gravity_m_s2;
  const double mu_hat = friction_on_ ? soil.mu_hat : 0;
  return {.dt = narrow<float>(dt_s),
          .weight_x = narrow<float>(weight.x()),
          .weight_y = narrow<float>(weight.y()),
          .weight_z = narrow<float>(weight.z()),
          .inverse_mass = narrow<float>(1 / mass_kg_),
          // c = k dt / 2 for each contact (paper 20), with the step that is really taken
          .damping = narrow<float>(soil.stiffness_n_m * dt_s / 2),
          .static_friction = narrow<float>(mu_hat),
          .moving_friction = narrow<float>(mu_hat * soil.moving_friction_ratio),
          .skin_half_squared = skin_m_ * skin_m_ / 4,
          .friction_ratio = friction_on_ ? 1.0F : 0.0F,
          .drag = friction_on_ ? 1 : 1 / (1 + kSettlingDrag_per_s * narrow<float>(dt_s))};
}

bool Bed::rebuildNeighbours() noexcept {
  std::copy(state_.position.begin(), state_.position.end(), state_.listed_at.begin());
  ++rebuilds_;
  if (!neighbours_.build(state_.position)) {
    return false;
  }
  if (isPairwise()) {  // within reserved storage: nothing allocates
    next_slip_x_.assign(neighbours_.slots(), 0);
    next_slip_y_.assign(neighbours_.slots(), 0);
    next_slip_z_.assign(neighbours_.slots(), 0);
    if (!state_.slip_x.empty()) {
      carryMemory(neighbours_.previous(), memory(), neighbours_.view(),
                  {next_slip_x_.data(), next_slip_y_.data(), next_slip_z_.data()}, particles());
    }
    state_.slip_x.swap(next_slip_x_);
    state_.slip_y.swap(next_slip_y_);
    state_.slip_z.swap(next_slip_z_);
  }
  return true;
}

void Bed::advancePart(int part, int parts) noexcept {
  const std::size_t n = particles();
  const std::size_t first = n * static_cast<std::size_t>(part) / static_cast<std::size_t>(parts);
  const std::size_t last = n * (static_cast<std::size_t>(part) + 1) / static_cast<std::size_t>(parts);
  sumNeighbours(first, last);

  Part result;
  for (std::size_t i = first; i < last; ++i) {
    advance(i);
    const Float4& here = next_position_[i];
    const Float4& listed = state_.listed_at[i];
    const float dx = here.x - listed.x;
    const float dy = here.y - listed.y;
    const float dz = here.z - listed.z;
    const float moved = dx * dx + dy * dy + dz * dz;
    result.moved_far = result.moved_far || moved > now_.skin_half_squared;
    result.finite = result.finite && std::isfinite(moved);
  }
  part_results_[static_cast<std::size_t>(part)] = result;
}

void Bed::sumNeighbours(std::size_t first, std::size_t last) noexcept {
  if (isPairwise()) {
    PairwiseLaw law = pairwise_law_;
    law.friction *= now_.friction_ratio;
    law.cohesion *= now_.friction_ratio;
    sumPairwiseContacts(law, periods_, now_.dt, state_.position.data(), state_.velocity.data(), neighbours_.view(),
                        memory(), first, last, sums_.data());
  } else {
    sumContacts(kernel_law_, periods_, state_.position.data(), neighbours_.view(), first, last, sums_.data());
  }
}

void Bed::advance(std::size_t i) noexcept {
  if (isDriven(i)) {
    moveOn(i, state_.velocity[i]);
  } else if (isPairwise()) {
    advanceWithPairwiseFriction(i);
  } else {
    advanceWithPaperFriction(i);
  }
}

void Bed::advanceWithPaperFriction(std::size_t i) noexcept {
  const ContactSum& sum = sums_[i];
  const Float4& x = state_.position[i];
  const Float4& push = external_[i];
  Load load{sum.force_x_n + now_.weight_x + push.x, sum.force_y_n + now_.weight_y + push.y,
            sum.force_z_n + now_.weight_z + push.z, sum.repulsion_n, sum.contacts};

  const float half_width = narrow<float>(parameters_.width_m / 2);
  const float half_length = narrow<float>(parameters_.length_m / 2);
  addWall(kernel_law_, x.z, 1, load.z, load);
  if (!parameters_.periodic_x) {
    addWall(kernel_law_, half_width + x.x, 1, load.x, load);
    addWall(kernel_law_, half_width - x.x, -1, load.x, load);
  }
  if (!parameters_.periodic_y) {
    addWall(kernel_law_, half_length + x.y, 1, load.y, load);
    addWall(kernel_law_, half_length - x.y, -1, load.y, load);
  }

  // A particle at rest stays at rest up to the static limit (paper 14, upper case).
  const Float4& v = state_.velocity[i];
  const bool at_rest = v.x == 0 && v.y == 0 && v.z == 0;
  const float limit = now_.static_friction * load.repulsion;
  if (at_rest && load.x * load.x + load.y * load.y + load.z * load.z <= limit * limit) {
    next_velocity_[i] = v;
    next_position_[i] = x;
    return;
  }

  // Semi-implicit: damping (paper 20) acts on the new velocity, so it can never overshoot.
  const float per_mass = now_.dt * now_.inverse_mass;
  const float kept = 1 / (1 + per_mass * now_.damping * load.contacts);
  float vx = (v.x + per_mass * load.x) * kept;
  float vy = (v.y + per_mass * load.y) * kept;
  float vz = (v.z + per_mass * load.z) * kept;

  // Moving friction (paper 14, lower case) against the velocity; it stops the particle but never turns it round.
  const float speed = std::sqrt(vx * vx + vy * vy + vz * vz);
  const float slowed_by = per_mass * now_.moving_friction * load.repulsion;
  const float left = speed > slowed_by ? 1 - slowed_by / speed : 0;
  moveOn(i, {vx * left, vy * left, vz * left, 0});
}

void Bed::advanceWithPairwiseFriction(std::size_t i) noexcept {
  const ContactSum& sum = sums_[i];
  const Float4& x = state_.position[i];
  const Float4& v = state_.velocity[i];
  const Float4& push = external_[i];
  WallSlip& slip = state_.wall_slip[i];
  const auto touch = [&](float ratio, const WallTouch& at, float& slip_1, float& slip_2) {
    return wallForce(pairwise_law_, now_.dt, now_.friction_ratio * ratio, at, slip_1, slip_2);
  };
  float fx = sum.force_x_n + now_.weight_x + push.x;
  float fy = sum.force_y_n + now_.weight_y + push.y;
  float fz = sum.force_z_n + now_.weight_z + push.z;

  const WallForce floor = touch(1, {x.z - x.w, v.z, v.x, v.y}, slip.floor_x, slip.floor_y);
  fx += floor.along_1;
  fy += floor.along_2;
  fz += floor.away;
  const float ratio = narrow<float>(parameters_.wall_friction_ratio);
  if (!parameters_.periodic_x) {
    const float inwards = x.x < 0 ? 1.0F : -1.0F;  // from the nearer of the two walls
    const float distance = narrow<float>(parameters_.width_m / 2) + inwards * x.x - x.w;
    const WallForce wall = touch(ratio, {distance, inwards * v.x, v.y, v.z}, slip.x_wall_y, slip.x_wall_z);
    fx += inwards * wall.away;
    fy += wall.along_1;
    fz += wall.along_2;
  }
  if (!parameters_.periodic_y) {
    const float inwards = x.y < 0 ? 1.0F : -1.0F;
    const float distance = narrow<float>(parameters_.length_m / 2) + inwards * x.y - x.w;
    const WallForce wall = touch(ratio, {distance, inwards * v.y, v.x, v.z}, slip.y_wall_x, slip.y_wall_z);
    fx += wall.along_1;
    fy += inwards * wall.away;
    fz += wall.along_2;
  }

  const float per_mass = now_.dt * now_.inverse_mass;
  moveOn(i,
         {(v.x + per_mass * fx) * now_.drag, (v.y + per_mass * fy) * now_.drag, (v.z + per_mass * fz) * now_.drag, 0});
}

void Bed::moveOn(std::size_t i, const Float4& velocity) noexcept {
  const Float4& x = state_.position[i];
  next_velocity_[i] = velocity;
  next_position_[i] = {x.x + now_.dt * velocity.x, x.y + now_.dt * velocity.y, x.z + now_.dt * velocity.z, x.w};
}

ContactMemory Bed::memory() noexcept {
  return {state_.slip_x.data(), state_.slip_y.data(), state_.slip_z.data()};
}

void Bed::drive(std::size_t particle, const Vec3& velocity_m_s) noexcept {
  state_.velocity[particle] = {narrow<float>(velocity_m_s.x()), narrow<float>(velocity_m_s.y()),
                               narrow<float>(velocity_m_s.z()), 1};
}

void Bed::release(std::size_t particle) noexcept {
  state_.velocity[particle].w = 0;
}

Vec3 Bed::contactForce(std::size_t particle) const noexcept {
  const ContactSum& sum = sums_[particle];
  return {sum.force_x_n, sum.force_y_n, sum.force_z_n};
}

void Bed::settle(double dt_s, double longest_s, const SettleProgress& progress) {
  constexpr double kAtRest_m_s = 1e-4;
  constexpr int kStepsBetweenLooks = 100;
  friction_on_ = false;
  const struct FrictionAgain {  // however this ends
    bool& on;
    ~FrictionAgain() { on = true; }
  } friction_again{friction_on_};
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
  } while (speed > kAtRest_m_s);
  for (std::size_t i = 0; i < particles(); ++i) {
    state_.velocity[i] = isDriven(i) ? state_.velocity[i] : Float4{};
  }
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
  const ContactLaw pair = cohering(law_, 1);
  const ContactLaw floor = cohering(wall_law_, 1);
  const ContactLaw side_wall = cohering(wall_law_, parameters_.wall_friction_ratio);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 x = at(i);
    const Float4& v = state_.velocity[i];
    energy += mass_kg_ / 2 * Vec3(v.x, v.y, v.z).squaredNorm() - mass_kg_ * parameters_.gravity_m_s2.dot(x);
    // Half of a pair's: the mirror image moves as far as the particle.
    const double excess = state_.position[i].w;
    const auto to_walls = [&](double across_m, double from_middle_m) {
      return contactEnergy(side_wall, across_m - 2 * (std::abs(from_middle_m) + excess)) / 2;
    };
    energy += contactEnergy(floor, 2 * (x.z() - excess)) / 2;
    energy += parameters_.periodic_x ? 0 : to_walls(parameters_.width_m, x.x());
    energy += parameters_.periodic_y ? 0 : to_walls(parameters_.length_m, x.y());
    for (std::uint32_t s = neighbours_.begin(i); s < neighbours_.end(i); ++s) {
      const auto j = static_cast<std::size_t>(neighbours_.indices()[s]);
      if (j > i && j < n) {
        Vec3 apart = x - at(j);
        apart.x() -= periods_.width * std::round(apart.x() * periods_.per_width);
        apart.y() -= periods_.length * std::round(apart.y() * periods_.per_length);
        energy += contactEnergy(pair, apart.norm() - excess - state_.position[j].w);
        if (isPairwise()) {
          const Vec3 slip(state_.slip_x[s], state_.slip_y[s], state_.slip_z[s]);
          energy += pairwise_law_.stiffness / 2 * slip.squaredNorm();
        }
      }
    }
    if (isPairwise()) {
      const WallSlip& slip = state_.wall_slip[i];
      for (const float slid :
           {slip.floor_x, slip.floor_y, slip.x_wall_y, slip.x_wall_z, slip.y_wall_x, slip.y_wall_z}) {
        energy += pairwise_law_.stiffness / 2 * slid * slid;
      }
    }
  }
  return energy;
}

double Bed::largestSpeed() const noexcept {
  float largest = 0;
  for (const Float4& v : state_.velocity) {
    if (v.w != 0) {
      continue;
    }
    largest = std::max(largest, v.x * v.x + v.y * v.y + v.z * v.z);
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

void Bed::restore(const BedState& state) {
  const std::size_t records = particles() + 1;
  if (state.particles() != particles() || state.position.size() != records || state.velocity.size() != records ||
      state.listed_at.size() != records) {
    throw InvalidParameter("state", fmt::format("{} particles", state.particles()),
                           fmt::format("of this bed's {} particles", particles()));
  }
  // A saved state may come from a file: a position that is no number would become the number of a cell.
  const auto is_number = [](const Float4& r) {
    return std::isfinite(r.x) && std::isfinite(r.y) && std::isfinite(r.z) && std::isfinite(r.w);
  };
  for (const auto* records_of : {&state.position, &state.velocity, &state.listed_at, &state.tool_slip}) {
    if (!std::all_of(records_of->begin(), records_of->end(), is_number)) {
      throw InvalidParameter("state", "positions, velocities or slips that are no numbers", "finite");
    }
  }
  // The neighbour list reaches as far as the largest particle of this soil does.
  const auto largest = narrow<float>(largestExcess(parameters_.soil));
  if (!std::all_of(state.position.begin(), state.position.end(),
                   [largest](const Float4& p) { return std::abs(p.w) <= largest; })) {
    throw InvalidParameter("state", "particles of other sizes", "of this bed's size_spread");
  }
  const std::size_t remembered = isPairwise() ? particles() : 0;
  if (state.wall_slip.size() != remembered || state.tool_slip.size() != remembered) {
    throw InvalidParameter("state", remembered == 0 ? "with a memory of friction" : "without a memory of friction",
                           "of a bed with this bed's friction");
  }
  const auto finite = [](float value) { return std::isfinite(value); };
  const auto wall_is_number = [&finite](const WallSlip& slip) {
    return finite(slip.floor_x) && finite(slip.floor_y) && finite(slip.x_wall_y) && finite(slip.x_wall_z) &&
           finite(slip.y_wall_x) && finite(slip.y_wall_z);
  };
  bool numbers = std::all_of(state.wall_slip.begin(), state.wall_slip.end(), wall_is_number);
  for (const FloatArray* slip : {&state.slip_x, &state.slip_y, &state.slip_z}) {
    numbers = numbers && std::all_of(slip->begin(), slip->end(), finite);
  }
  if (!numbers) {
    throw InvalidParameter("state", "a memory of friction that is no number", "finite");
  }
  const bool built = neighbours_.build(state.listed_at);
  const std::size_t slips = isPairwise() ? neighbours_.slots() : 0;
  if (!built || state.slip_x.size() != slips || state.slip_y.size() != slips || state.slip_z.size() != slips) {
    (void)neighbours_.build(state_.listed_at);  // that one fitted when it was made
    throw InvalidParameter(
        "state", built ? "a memory of friction that does not fit its contacts" : "a bed that has collapsed onto itself",
        built ? "as it was saved" : "particles apart from each other");
  }
  state_.step = state.step;  // piece by piece: what is reserved stays reserved
  state_.position = state.position;
  state_.velocity = state.velocity;
  state_.listed_at = state.listed_at;
  state_.tool_side = state.tool_side;
  state_.slip_x = state.slip_x;
  state_.slip_y = state.slip_y;
  state_.slip_z = state.slip_z;
  state_.wall_slip = state.wall_slip;
  state_.tool_slip = state.tool_slip;
  state_.position.back() = state_.listed_at.back() = kGhost;
}

}  // namespace haptolith

#include "haptolith/bed/bed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/bed/bed_start.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/core/error.h"
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

constexpr Float4 kGhost{1e9F, 1e9F, 1e9F, 0};

/// Lets wrong parameters go no further than the first member that would be made of them.
const BedParameters& validated(const BedParameters& parameters) {
  validate(parameters);
  return parameters;
}

int usefulThreads(int wanted, std::size_t particles) {
  return std::clamp(static_cast<int>(particles / kParticlesPerThread), 1, wanted);
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
      mass_kg_(macroparticleMass(parameters.soil)),
      skin_m_(narrow<float>(kSkinRadii * parameters.soil.radius_m)),
      neighbours_(centres_m.size(), law_.cutoff_m + skin_m_, parameters.width_m, parameters.length_m),
      team_(usefulThreads(parameters.threads, centres_m.size())),
      part_results_(static_cast<std::size_t>(team_.size())) {
  const std::size_t n = centres_m.size();
  for (const Vec3& centre : centres_m) {
    if (!centre.cast<float>().allFinite()) {
      throw InvalidParameter("centres_m", fmt::format("{} {} {}", centre.x(), centre.y(), centre.z()), "finite");
    }
    state_.position.push_back({narrow<float>(centre.x()), narrow<float>(centre.y()), narrow<float>(centre.z()), 0});
  }
  state_.position.push_back(kGhost);
  state_.velocity.resize(n + 1);
  state_.tool_side.resize(n);
  state_.listed_at = state_.position;
  next_position_ = state_.position;
  external_.resize(n);
  sums_.resize(n);
  if (!rebuildNeighbours()) {
    throw InvalidParameter("centres_m", fmt::format("{} particles", n), "apart from each other");
  }
}

StepStatus Bed::step(double dt_s) noexcept {
  now_ = constantsFor(dt_s);
  team_.run([](void* bed, int part, int parts) noexcept { static_cast<Bed*>(bed)->advancePart(part, parts); }, this);
  state_.position.swap(next_position_);
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
          .skin_half_squared = skin_m_ * skin_m_ / 4};
}

bool Bed::rebuildNeighbours() noexcept {
  std::copy(state_.position.begin(), state_.position.end(), state_.listed_at.begin());
  ++rebuilds_;
  return neighbours_.build(state_.position);
}

void Bed::advancePart(int part, int parts) noexcept {
  const std::size_t n = particles();
  const std::size_t first = n * static_cast<std::size_t>(part) / static_cast<std::size_t>(parts);
  const std::size_t last = n * (static_cast<std::size_t>(part) + 1) / static_cast<std::size_t>(parts);
  sumContacts(kernel_law_, state_.position.data(), neighbours_.view(), first, last, sums_.data());

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

void Bed::advance(std::size_t i) noexcept {
  const ContactSum& sum = sums_[i];
  const Float4& x = state_.position[i];
  const Float4& push = external_[i];
  Load load{sum.force_x_n + now_.weight_x + push.x, sum.force_y_n + now_.weight_y + push.y,
            sum.force_z_n + now_.weight_z + push.z, sum.repulsion_n, sum.contacts};

  const float half_width = narrow<float>(parameters_.width_m / 2);
  const float half_length = narrow<float>(parameters_.length_m / 2);
  addWall(kernel_law_, x.z, 1, load.z, load);
  addWall(kernel_law_, half_width + x.x, 1, load.x, load);
  addWall(kernel_law_, half_width - x.x, -1, load.x, load);
  addWall(kernel_law_, half_length + x.y, 1, load.y, load);
  addWall(kernel_law_, half_length - x.y, -1, load.y, load);

  // A particle at rest stays at rest up to the static limit (paper 14, upper case).
  Float4& v = state_.velocity[i];
  const bool at_rest = v.x == 0 && v.y == 0 && v.z == 0;
  const float limit = now_.static_friction * load.repulsion;
  if (at_rest && load.x * load.x + load.y * load.y + load.z * load.z <= limit * limit) {
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
  v = {vx * left, vy * left, vz * left, 0};
  next_position_[i] = {x.x + now_.dt * v.x, x.y + now_.dt * v.y, x.z + now_.dt * v.z, 0};
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
  std::fill(state_.velocity.begin(), state_.velocity.end(), Float4{});
  state_.step = 0;
}

double Bed::energy() const {
  double energy = 0;
  const std::size_t n = particles();
  const auto at = [this](std::size_t i) {
    const Float4& p = state_.position[i];
    return Vec3(p.x, p.y, p.z);
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 x = at(i);
    const Float4& v = state_.velocity[i];
    energy += mass_kg_ / 2 * Vec3(v.x, v.y, v.z).squaredNorm() - mass_kg_ * parameters_.gravity_m_s2.dot(x);
    for (const double distance :
         {x.z(), parameters_.width_m / 2 - std::abs(x.x()), parameters_.length_m / 2 - std::abs(x.y())}) {
      energy += contactEnergy(wall_law_, 2 * distance) / 2;  // half: the mirror image moves as far as the particle
    }
    for (std::uint32_t s = neighbours_.begin(i); s < neighbours_.end(i); ++s) {
      const auto j = static_cast<std::size_t>(neighbours_.indices()[s]);
      if (j > i && j < n) {
        energy += contactEnergy(law_, (x - at(j)).norm());
      }
    }
  }
  return energy;
}

double Bed::largestSpeed() const noexcept {
  float largest = 0;
  for (const Float4& v : state_.velocity) {
    largest = std::max(largest, v.x * v.x + v.y * v.y + v.z * v.z);
  }
  return std::sqrt(largest);
}

double Bed::surfaceHeight() const noexcept {
  float highest = 0;
  for (std::size_t i = 0; i < particles(); ++i) {
    highest = std::max(highest, state_.position[i].z);
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
  const auto is_number = [](const Float4& r) { return std::isfinite(r.x) && std::isfinite(r.y) && std::isfinite(r.z); };
  for (const auto* records_of : {&state.position, &state.velocity, &state.listed_at}) {
    if (!std::all_of(records_of->begin(), records_of->end(), is_number)) {
      throw InvalidParameter("state", "positions or velocities that are no numbers", "finite");
    }
  }
  if (!neighbours_.build(state.listed_at)) {
    (void)neighbours_.build(state_.listed_at);  // that one fitted when it was made
    throw InvalidParameter("state", "a bed that has collapsed onto itself", "particles apart from each other");
  }
  state_ = state;
  state_.position.back() = state_.listed_at.back() = kGhost;
}

}  // namespace haptolith

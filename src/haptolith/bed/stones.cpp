#include "haptolith/bed/stones.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "haptolith/bed/start/bed_tile.h"
#include "haptolith/bed/stones_internal.h"
#include "haptolith/core/assert.h"

namespace haptolith {

namespace {

/// Skin of the stones' neighbour lists, in radii of the coarsest particles: lists are rebuilt when the total movement
/// reaches it. Larger: longer lists in every step; smaller: more rebuilds.
constexpr double kMarginRadii = 0.5;

/// Grains in a volume at most, over those that would fill it whole: closer packings than the closest are pressed.
constexpr double kDensest = 1.0;

double ballVolume(double radius_m) {
  return 4.0 / 3.0 * std::numbers::pi * radius_m * radius_m * radius_m;
}

/// A small turn about one of a body's own axes. Without the library's sine, whose last digit differs between machines:
/// tan(x) = x + x^3 / 3 is right to twelve digits for what a stone turns in a step.
Quat aboutAxis(int axis, double angle_rad) noexcept {
  const double half = angle_rad / 2;
  const double tangent = half + half * half * half / 3;
  const double cosine = 1 / std::sqrt(1 + tangent * tangent);
  Quat turn(cosine, 0, 0, 0);
  turn.vec()[axis] = cosine * tangent;
  return turn;
}

}  // namespace

Stones::Stones(const BedParameters& bed, double skin_m, std::vector<std::shared_ptr<const StoneShape>> shapes,
               const std::vector<bool>& fixed)
    : soil_(bed.soil),
      classes_(bed.soil.radius_m, grainClasses(bed)),
      density_kg_m3_(bed.stones.density_kg_m3),
      half_width_m_(bed.width_m / 2 + heldWidth(bed)),
      half_length_m_(bed.length_m / 2 + heldWidth(bed)),
      wall_ratio_(wallRatio(bed)),
      skin_m_(skin_m),
      rest_steps_(restRule(bed).steps),
      shapes_(std::move(shapes)),
      spheres_(shapes_.size()),
      bodies_(shapes_.size()),
      memory_(shapes_.size()),
      with_soil_(shapes_.size()),
      with_walls_(shapes_.size()),
      with_floor_(shapes_.size()) {
  state_.stones.resize(shapes_.size());
  const double finest_m = GrainClasses::scale(classes_.count() - 1) * soil_.radius_m;
  std::size_t most_touched = 0;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const StoneShape& shape = *shapes_[i];
    Body& body = bodies_[i];
    body.mass_kg = density_kg_m3_ * shape.volume_m3;
    body.inertia_kg_m2 = density_kg_m3_ * shape.inertia_m5;
    body.radius_m = shape.radius();
    body.fixed = fixed[i];
    body.inverse_mass = body.fixed ? 0 : 1 / body.mass_kg;
    body.inverse_inertia = body.fixed ? Vec3::Zero() : Vec3(body.inertia_kg_m2.cwiseInverse());
    body.centres_m.resize(shape.spheres.size());
    const double around_m = shape.reach_m + soil_.radius_m * (2 + soil_.size_spread) + margin() +
                            soil_.cohesion_range_ratio * soil_.radius_m;
    const auto most_near = static_cast<std::size_t>(kDensest * std::max(ballVolume(around_m) - shape.volume_m3, 0.0) /
                                                    ballVolume(finest_m)) +
                           16;
    for (const StoneSphere& sphere : shape.spheres) {
      const auto f = [](double value) { return static_cast<float>(value); };
      spheres_[i].push_back(
          {f(sphere.centre_m.x()), f(sphere.centre_m.y()), f(sphere.centre_m.z()), f(sphere.radius_m)});
    }
    Memory& memory = memory_[i];
    const std::size_t most_packs = most_near / kGroup + GrainClasses::kMost;
    memory.packs.reserve(most_packs);
    memory.spheres.reserve(most_packs * shape.spheres.size());
    memory.candidates.reserve(most_near);
    memory.near_now.resize((shape.spheres.size() + kSphereBits - 1) / kSphereBits);
    memory.before.reserve(most_near);
    memory.groups.reserve(most_near);
    memory.pushes.reserve(most_near);
    const std::size_t most_stones = std::min(shapes_.size(), kMostPartners);
    memory.pairs.reserve(most_stones);
    memory.stones.reserve(most_stones * shape.spheres.size());
    memory.stones_before.reserve(most_stones * shape.spheres.size());
    memory.walls.resize(shape.spheres.size());
    memory.looked_at_m = -margin() * static_cast<double>(i) / static_cast<double>(shapes_.size());
    most_touched += most_near;
  }
  put_.reserve(most_touched);
  makeLaws();
}

double Stones::margin() const noexcept {
  return kMarginRadii * soil_.radius_m;
}

void Stones::makeLaws() noexcept {
  for (std::size_t i = 0; i < size(); ++i) {
    const double r = bodies_[i].radius_m;
    const double m = bodies_[i].mass_kg;
    with_floor_[i] = StoneContactLaw::bare(soil_, {r, r, m, m});
    with_walls_[i] = StoneContactLaw::bare(soil_, {r, r, m, m}, wall_ratio_);
    for (int c = 0; c < classes_.count(); ++c) {
      const SoilParameters grains = rescaled(soil_, GrainClasses::scale(c) * soil_.radius_m);
      const StoneContactLaw law =
          StoneContactLaw::withGrains(grains, {r, grains.radius_m, m, macroparticleMass(grains)});
      with_soil_[i][static_cast<std::size_t>(c)] = {law, law.inKernel()};
    }
    memory_[i].look = true;  // contacts may reach further, and those between stones are others
  }
}

Pose Stones::pose(std::size_t stone) const noexcept {
  return state_.stones[stone].scene_T_stone;
}

std::vector<Pose> Stones::poses() const {
  std::vector<Pose> poses;
  for (const StoneState& stone : state_.stones) {
    poses.push_back(stone.scene_T_stone);
  }
  return poses;
}

Twist Stones::twist(std::size_t stone) const noexcept {
  return {state_.stones[stone].velocity_m_s, bodies_[stone].angular_rad_s};
}

void Stones::place(std::size_t stone, const Pose& scene_T_stone, const Twist& twist) noexcept {
  StoneState& state = state_.stones[stone];
  Body& body = bodies_[stone];
  state.scene_T_stone = {scene_T_stone.position_m, scene_T_stone.orientation.normalized()};
  state.velocity_m_s = twist.linear_m_s;
  const Eigen::Matrix3d rotation = state.scene_T_stone.orientation.toRotationMatrix();
  state.angular_momentum_nms = rotation * body.inertia_kg_m2.cwiseProduct(rotation.transpose() * twist.angular_rad_s);
  state.rested_at = state.scene_T_stone;
  state.rested = 0;
  noteTurn(stone);
  lookAgain();
}

void Stones::push(std::size_t stone, const Vec3& force_n, const Vec3& point_m) noexcept {
  bodies_[stone].pushed.add(force_n, point_m - state_.stones[stone].scene_T_stone.position_m);
  wake(stone);
}

void Stones::wake(std::size_t stone) noexcept {
  StoneState& state = state_.stones[stone];
  if (state.asleep()) {
    state.rested = rest_steps_;  // at rest, until it moves
  }
}

void Stones::wakeAll() noexcept {
  for (std::size_t i = 0; i < size(); ++i) {
    wake(i);
  }
}

void Stones::lookAgain() noexcept {
  for (Memory& memory : memory_) {
    memory.look = true;
  }
}

void Stones::stop() noexcept {
  for (std::size_t i = 0; i < size(); ++i) {
    state_.stones[i].velocity_m_s.setZero();
    state_.stones[i].angular_momentum_nms.setZero();
    state_.stones[i].rested_at = state_.stones[i].scene_T_stone;
    noteTurn(i);
  }
}

void Stones::slowDown(double dt_s) noexcept {
  constexpr double kMostInStep = 0.2;
  for (std::size_t i = 0; i < size(); ++i) {
    StoneState& state = state_.stones[i];
    const double gone = state.velocity_m_s.norm() * dt_s / bodies_[i].radius_m;
    const double turned = bodies_[i].angular_rad_s.norm() * dt_s;
    if (gone > kMostInStep) {
      state.velocity_m_s *= kMostInStep / gone;
    }
    if (turned > kMostInStep) {
      state.angular_momentum_nms *= kMostInStep / turned;
      noteTurn(i);
    }
  }
}

void Stones::setSoil(const SoilParameters& soil) noexcept {
  soil_ = soil;
  makeLaws();
  wakeAll();
}

void Stones::growIn(double short_m) noexcept {
  if (short_m == short_m_) {
    return;
  }
  went_m_ += std::abs(short_m - short_m_);
  short_m_ = short_m;
  wakeAll();
}

void Stones::begin(double dt_s) noexcept {
  HAPTO_ASSERT(dt_s > 0);
  dt_s_ = dt_s;
  put_.clear();
}

int Stones::parts() const noexcept {
  constexpr std::ptrdiff_t kStonesInPart = 4;  // worth sharing out
  const auto awake = std::ranges::count_if(state_.stones, [](const StoneState& stone) { return !stone.asleep(); });
  return static_cast<int>(std::clamp<std::ptrdiff_t>(awake / kStonesInPart, 1, static_cast<std::ptrdiff_t>(size())));
}

void Stones::press(const SoilAroundStones& soil, int part, int parts) noexcept {
  HAPTO_ASSERT(part >= 0 && part < parts);
  const auto begin_of = [&](int p) { return size() * static_cast<std::size_t>(p) / static_cast<std::size_t>(parts); };
  for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) {
    bodies_[i].contact = {};
    Memory& memory = memory_[i];
    memory.pushes.clear();
    if (memory.look || went_m_ - memory.looked_at_m > margin()) {
      memory.has_room = lookAround(i, soil);
    }
    memory.beside_unrest =
        std::ranges::any_of(memory.groups, [&](std::uint32_t group) { return !soil.state.asleep(group); });
    if (memory.beside_unrest) {
      wake(i);
    }
    if (memory.has_room && !state_.stones[i].asleep()) {
      pressSoil(i, soil);
      pressWalls(i);
    }
  }
}

bool Stones::putForces(const SoilAroundStones& soil) noexcept {
  if (!std::ranges::all_of(memory_, &Memory::has_room)) {
    return false;
  }
  for (std::size_t i = 0; i < size(); ++i) {
    pressStones(i, soil);
  }
  for (std::size_t i = 0; i < size(); ++i) {
    const bool moving = short_m_ > 0 || (!bodies_[i].fixed && state_.stones[i].rested < soil.wakefulness.rule().steps);
    for (const Push& push : memory_[i].pushes) {
      Float4& sum = soil.forces[push.particle];
      put_.push_back({push.particle, sum});
      sum.x += push.force_n[0];
      sum.y += push.force_n[1];
      sum.z += push.force_n[2];
      if (moving && soil.state.asleep(push.particle / kGroup)) {
        soil.wakefulness.wake(push.particle / kGroup, soil.state);
      }
    }
  }
  return true;
}

bool Stones::areFinite() const noexcept {
  return std::ranges::all_of(state_.stones, [](const StoneState& stone) {
    return stone.scene_T_stone.position_m.allFinite() && stone.scene_T_stone.orientation.coeffs().allFinite();
  });
}

void Stones::pressSoil(std::size_t stone, const SoilAroundStones& soil) noexcept {
  HAPTO_ASSERT(stone < size());
  HAPTO_ASSERT(dt_s_ > 0);
  Body& body = bodies_[stone];
  Memory& memory = memory_[stone];
  const StoneState& state = state_.stones[stone];
  const StoneMotion motion(state.scene_T_stone.position_m, body.rotation, state.velocity_m_s,
                           inFrame(body.rotation, body.angular_rad_s));
  PackTouch touch;
  for (StonePack& pack : memory.packs) {
    if (went_m_ < pack.apart_until_m) {
      continue;
    }
    pressPack({.law = with_soil_[stone][static_cast<std::size_t>(pack.grain_class)].in_kernel,
               .motion = motion,
               .spheres = spheres_[stone].data(),
               .numbers = std::span(memory.spheres).subspan(pack.first_sphere, pack.sphere_count),
               .grain_m = static_cast<float>(soil_.radius_m - short_m_),
               .dt_s = static_cast<float>(dt_s_)},
              soil.state.position.data(), soil.state.velocity.data(), pack, touch);
    pack.apart_until_m = went_m_ + *std::ranges::min_element(touch.beyond_m);
    for (std::size_t k = 0; k < pack.count; ++k) {
      if (touch.beyond_m[k] < 0) {
        const Stretch force{touch.force_n[0][k], touch.force_n[1][k], touch.force_n[2][k]};
        memory.pushes.push_back({static_cast<std::uint32_t>(pack.particle[k]), force});
        body.contact.add(-vectorOf(force), {touch.lever_m[0][k], touch.lever_m[1][k], touch.lever_m[2][k]});
      }
    }
  }
}

void Stones::pressWalls(std::size_t stone) noexcept {
  HAPTO_ASSERT(stone < size());
  Body& body = bodies_[stone];
  Memory& memory = memory_[stone];
  const StoneShape& shape = *shapes_[stone];
  const Vec3 middle = state_.stones[stone].scene_T_stone.position_m;
  struct Wall {
    double gap_m;  ///< gap to the sphere around the stone
    Vec3 inwards;
    const StoneContactLaw& law;
  };
  const auto sign = [](double of) { return of < 0 ? 1.0 : -1.0; };  // from the nearer of two walls
  const std::array<Wall, 3> walls{
      Wall{middle.z() - shape.reach_m, Vec3::UnitZ(), with_floor_[stone]},
      Wall{half_width_m_ - std::abs(middle.x()) - shape.reach_m, sign(middle.x()) * Vec3::UnitX(), with_walls_[stone]},
      Wall{half_length_m_ - std::abs(middle.y()) - shape.reach_m, sign(middle.y()) * Vec3::UnitY(),
           with_walls_[stone]}};
  const bool near = std::ranges::any_of(walls, [](const Wall& wall) { return wall.gap_m < 0; });
  if (!near && !memory.touched_walls) {
    return;
  }
  memory.touched_walls = near;
  for (std::size_t s = 0; s < shape.spheres.size(); ++s) {
    const Vec3& centre = body.centres_m[s];
    const double radius_m = shape.spheres[s].radius_m;
    const std::array<double, 3> gaps_m{centre.z() - radius_m, half_width_m_ - std::abs(centre.x()) - radius_m,
                                       half_length_m_ - std::abs(centre.y()) - radius_m};
    for (std::size_t w = 0; w < walls.size(); ++w) {
      Stretch& kept = memory.walls[s][w];
      if (gaps_m[w] >= 0) {
        kept = {};
        continue;
      }
      const Vec3& n = walls[w].inwards;
      const Vec3 lever = centre - (radius_m + gaps_m[w]) * n - middle;
      const Vec3 velocity = velocityAt(stone, lever);
      Vec3 stretch = vectorOf(kept);
      // The wall is the stone's mirror image, which comes as fast as it goes, and does not slide.
      const Vec3 force = walls[w].law.force({-2 * gaps_m[w], n, 1}, velocity + velocity.dot(n) * n, dt_s_, stretch);
      kept = stretchOf(stretch);
      body.contact.add(force, lever);
    }
  }
}

void Stones::wakeBesideAnother(std::size_t stone, const SoilAroundStones& soil) noexcept {
  HAPTO_ASSERT(stone < size());
  memory_[stone].beside_unrest = true;
  if (state_.stones[stone].asleep()) {
    wake(stone);
    pressSoil(stone, soil);  // which it slept through
    pressWalls(stone);
  }
}

void Stones::pressStones(std::size_t stone, const SoilAroundStones& soil) noexcept {
  HAPTO_ASSERT(stone < size());
  Memory& memory = memory_[stone];
  Body& body = bodies_[stone];
  const StoneShape& shape = *shapes_[stone];
  const Vec3 middle = state_.stones[stone].scene_T_stone.position_m;
  for (NearStone& near : memory.stones) {
    const Pair& pair = memory.pairs[near.pair];
    const std::size_t other = pair.stone;
    StoneState& mine = state_.stones[stone];
    StoneState& theirs = state_.stones[other];
    if (mine.asleep() && theirs.asleep()) {
      continue;
    }
    const Vec3& centre = body.centres_m[near.sphere];
    const double radius_m = shape.spheres[near.sphere].radius_m;
    const StoneShape& with = *shapes_[other];
    OverlapOfSpheres spheres;
    for (std::size_t s = 0; s < with.spheres.size(); ++s) {
      spheres.add(centre - bodies_[other].centres_m[s], with.spheres[s].radius_m + radius_m);
    }
    const Overlap overlap = spheres.overlap();
    if (overlap.depth_m <= 0) {
      near.stretch = {};
      continue;
    }
    if (theirs.rested == 0) {
      wakeBesideAnother(stone, soil);
    }
    if (mine.rested == 0) {
      wakeBesideAnother(other, soil);
    }
    const Vec3 point = centre - (radius_m - overlap.depth_m / 2) * overlap.towards;
    const Vec3 their_middle = theirs.scene_T_stone.position_m;
    const Vec3 relative = velocityAt(stone, point - middle) - velocityAt(other, point - their_middle);
    Vec3 stretch = vectorOf(near.stretch);
    const Vec3 force = pair.law.force(overlap, relative, dt_s_, stretch);
    near.stretch = stretchOf(stretch);
    body.contact.add(force, point - middle);
    bodies_[other].contact.add(-force, point - their_middle);
  }
}

void Stones::takeBackForces(std::vector<Float4>& forces) noexcept {
  for (std::size_t k = put_.size(); k > 0; --k) {
    forces[put_[k - 1].particle] = put_[k - 1].before;
  }
}

void Stones::move(const Vec3& gravity_m_s2, double dt_s, const RestRule& rest) noexcept {
  HAPTO_ASSERT(dt_s > 0);
  rest_steps_ = rest.steps;
  double fastest_m_s = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    StoneState& state = state_.stones[i];
    Body& body = bodies_[i];
    const Wrench wrench{body.contact.force_n + body.pushed.force_n, body.contact.torque_nm + body.pushed.torque_nm};
    body.pushed = {};
    if (short_m_ > 0) {
      continue;
    }
    if (body.fixed) {
      state.rested = rest.sleep && !memory_[i].beside_unrest ? StoneState::kAsleep : std::uint16_t{1};
      continue;
    }
    if (state.asleep()) {
      continue;
    }
    state.velocity_m_s += dt_s * (body.inverse_mass * wrench.force_n + gravity_m_s2);
    state.scene_T_stone.position_m += dt_s * state.velocity_m_s;
    state.angular_momentum_nms += dt_s * wrench.torque_nm;
    turn(i, dt_s);
    fastest_m_s = std::max(fastest_m_s, state.velocity_m_s.norm() + body.angular_rad_s.norm() * shapes_[i]->reach_m);
    this->rest(i, rest);
  }
  went_m_ += 2 * fastest_m_s * dt_s;
}

/// Rotates a free body by successive short rotations about its principal axes (McLachlan 1993, "Explicit
/// Lie-Poisson integration"): its angular momentum in the scene is conserved exactly, and its energy oscillates
/// slightly about the true value.
void Stones::turn(std::size_t stone, double dt_s) noexcept {
  HAPTO_ASSERT(stone < size());
  HAPTO_ASSERT(!bodies_[stone].fixed);
  StoneState& state = state_.stones[stone];
  const Body& body = bodies_[stone];
  Quat& q = state.scene_T_stone.orientation;
  const auto about = [&](int axis, double step_s) {
    const double along = (q.conjugate() * state.angular_momentum_nms)[axis];
    q = q * aboutAxis(axis, step_s * along * body.inverse_inertia[axis]);
  };
  about(0, dt_s / 2);
  about(1, dt_s / 2);
  about(2, dt_s);
  about(1, dt_s / 2);
  about(0, dt_s / 2);
  q.normalize();
  noteTurn(stone);
}

void Stones::noteTurn(std::size_t stone) noexcept {
  HAPTO_ASSERT(stone < size());
  const StoneState& state = state_.stones[stone];
  Body& body = bodies_[stone];
  body.rotation = state.scene_T_stone.orientation.toRotationMatrix();
  body.angular_rad_s =
      body.rotation * body.inverse_inertia.cwiseProduct(inFrame(body.rotation, state.angular_momentum_nms));
  for (std::size_t s = 0; s < body.centres_m.size(); ++s) {
    body.centres_m[s] = state.scene_T_stone.position_m + body.rotation * shapes_[stone]->spheres[s].centre_m;
  }
}

void Stones::rest(std::size_t stone, const RestRule& rule) noexcept {
  HAPTO_ASSERT(stone < size());
  StoneState& state = state_.stones[stone];
  const Body& body = bodies_[stone];
  const double reach_m = shapes_[stone]->reach_m;
  const double speed_m_s = state.velocity_m_s.norm() + body.angular_rad_s.norm() * reach_m;
  const double crept_m =
      (state.scene_T_stone.position_m - state.rested_at.position_m).norm() +
      reach_m * 2 * (state.scene_T_stone.orientation.conjugate() * state.rested_at.orientation).vec().norm();
  if (speed_m_s > rule.speed_m_s || crept_m > rule.distance_m) {
    state.rested = 0;
    state.rested_at = state.scene_T_stone;
  } else if (state.rested < rule.steps) {
    ++state.rested;
  } else if (rule.sleep && !memory_[stone].beside_unrest) {
    state.rested = StoneState::kAsleep;
    state.velocity_m_s.setZero();
    state.angular_momentum_nms.setZero();
    noteTurn(stone);
  }
}

double Stones::largestSpeed() const noexcept {
  double largest = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (!bodies_[i].fixed && !asleep(i)) {
      largest = std::max(largest,
                         state_.stones[i].velocity_m_s.norm() + bodies_[i].angular_rad_s.norm() * shapes_[i]->reach_m);
    }
  }
  return largest;
}

double Stones::depthOf(const Vec3& centre_m, double radius_m) const {
  double depth_m = -std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < size(); ++i) {
    for (std::size_t s = 0; s < bodies_[i].centres_m.size(); ++s) {
      depth_m =
          std::max(depth_m, radius_m + shapes_[i]->spheres[s].radius_m - (centre_m - bodies_[i].centres_m[s]).norm());
    }
  }
  return depth_m;
}

double Stones::energy(const BedState& soil, const Vec3& gravity_m_s2) const {
  double energy = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    const StoneState& state = state_.stones[i];
    const Body& body = bodies_[i];
    const Memory& memory = memory_[i];
    const StoneShape& shape = *shapes_[i];
    if (!body.fixed) {
      energy +=
          body.mass_kg * (state.velocity_m_s.squaredNorm() / 2 - gravity_m_s2.dot(state.scene_T_stone.position_m)) +
          state.angular_momentum_nms.dot(body.angular_rad_s) / 2;
    }
    for (const StonePack& pack : memory.packs) {
      const StoneContactLaw& law = with_soil_[i][static_cast<std::size_t>(pack.grain_class)].law;
      for (std::size_t k = 0; k < pack.count; ++k) {
        const Float4& at = soil.position[static_cast<std::size_t>(pack.particle[k])];
        OverlapOfSpheres with;
        for (std::size_t s = 0; s < shape.spheres.size(); ++s) {
          with.add(placeOf(at) - body.centres_m[s], shape.spheres[s].radius_m - short_m_ + soil_.radius_m + at.w);
        }
        const double depth_m = with.overlap().depth_m;
        const Stretch stretch{pack.stretch_m[0][k], pack.stretch_m[1][k], pack.stretch_m[2][k]};
        energy += -depth_m < law.reach() ? law.energy(depth_m, vectorOf(stretch)) : 0;
      }
    }
    for (std::size_t s = 0; s < shape.spheres.size(); ++s) {
      const Vec3& centre = body.centres_m[s];
      const double radius_m = shape.spheres[s].radius_m;
      const std::array<double, 3> gaps_m{centre.z() - radius_m, half_width_m_ - std::abs(centre.x()) - radius_m,
                                         half_length_m_ - std::abs(centre.y()) - radius_m};
      for (std::size_t w = 0; w < gaps_m.size(); ++w) {
        const StoneContactLaw& law = w == 0 ? with_floor_[i] : with_walls_[i];
        // Half of a pair's: the mirror image moves as far as the stone. Its friction is the stone's alone.
        const Vec3 stretch = vectorOf(memory.walls[s][w]);
        energy += gaps_m[w] < 0 ? (law.energy(-2 * gaps_m[w], stretch) + law.energy(0, stretch)) / 2 : 0;
      }
    }
    for (const NearStone& near : memory.stones) {
      const Pair& pair = memory.pairs[near.pair];
      OverlapOfSpheres with;
      for (std::size_t s = 0; s < shapes_[pair.stone]->spheres.size(); ++s) {
        with.add(body.centres_m[near.sphere] - bodies_[pair.stone].centres_m[s],
                 shapes_[pair.stone]->spheres[s].radius_m + shape.spheres[near.sphere].radius_m);
      }
      const double depth_m = with.overlap().depth_m;
      energy += depth_m > 0 ? pair.law.energy(depth_m, vectorOf(near.stretch)) : 0;
    }
  }
  return energy;
}

std::size_t Stones::bytes() const noexcept {
  std::size_t bytes = size() * (sizeof(Body) + sizeof(Memory) + sizeof(StoneState) + sizeof(with_soil_[0]));
  for (const Memory& memory : memory_) {
    bytes += memory.packs.capacity() * sizeof(StonePack) + memory.before.capacity() * sizeof(Slid) +
             memory.spheres.capacity() * sizeof(std::uint16_t) + memory.near_now.size() * sizeof(std::uint64_t) +
             (memory.candidates.capacity() + memory.groups.capacity()) * sizeof(std::uint32_t) +
             memory.pushes.capacity() * sizeof(Push) +
             (memory.stones.capacity() + memory.stones_before.capacity()) * sizeof(NearStone) +
             memory.pairs.capacity() * sizeof(Pair) + memory.walls.size() * sizeof(memory.walls[0]);
  }
  return bytes + put_.capacity() * sizeof(Put);
}

}  // namespace haptolith

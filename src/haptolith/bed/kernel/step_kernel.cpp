#include "haptolith/bed/kernel/step_kernel.h"

// This file is compiled once for every instruction set; the functions at its end pick the best one at run time.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "haptolith/bed/kernel/step_kernel.cpp"
#include <hwy/foreach_target.h>  // before highway.h
#include <hwy/highway.h>
#include "haptolith/bed/kernel/frictional_contacts-inl.h"
#include "haptolith/bed/kernel/icra2021_contacts-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

// Highway's dispatch tables take no noexcept functions; the public ones below are.

/// Distance from the reference position at which a list is rebuilt, over half the skin: 0.65 to 1, different for each
/// particle, so that particles that move alike are not all rebuilt in one step. 1 is the maximum that keeps every
/// contact listed; a lower minimum than 0.65 spreads rebuilds more evenly and causes more of them.
HWY_INLINE V skinFraction(std::size_t particle) {
  const D d;
  const hn::RebindToSigned<D> di;
  const auto number = hn::Iota(di, static_cast<std::int32_t>(particle & 0xFFFF));
  const auto scattered = hn::And(number * hn::Set(di, 101), hn::Set(di, 255));
  return MulAdd(hn::ConvertTo(d, scattered), set(0.35F / 255), set(0.65F));
}

/// Constants of the step for a class of particles: half the radius is an eighth of the mass.
struct ClassConstants {
  float skin_half_squared, inverse_mass;
  float weight_x, weight_y, weight_z;
  explicit ClassConstants(const StepConstants& now, int grain_class = 0)
      : ClassConstants(now, GrainClasses::scale(grain_class), GrainClasses::scale(3 * grain_class)) {}

 private:
  ClassConstants(const StepConstants& now, float radius, float volume)  // over those of class 0: powers of two
      : skin_half_squared(now.skin_half_squared * radius * radius),
        inverse_mass(now.inverse_mass / volume),
        weight_x(now.weight_x * volume),
        weight_y(now.weight_y * volume),
        weight_z(now.weight_z * volume) {}
};

/// Integrates positions; flags groups that move and particles that have left their reference position.
HWY_INLINE void integrate(const StepConstants& now, const ClassConstants& own, const StepArrays& arrays,
                          const Lanes& at, const Float4Vectors& here, const Float4Vectors& velocity, Moved& moved,
                          V& fastest_squared) {
  const D d;
  const V dt = set(now.dt);
  Float4Vectors next{MulAdd(dt, velocity.x, here.x), MulAdd(dt, velocity.y, here.y), MulAdd(dt, velocity.z, here.z),
                     here.w};
  if (arrays.remainder != nullptr) {  // compensated summation (Kahan 1965)
    Float4* const kept = arrays.remainder + at.particle();
    const Float4Vectors left = loadFloat4(kept);
    const Float4Vectors way{MulAdd(dt, velocity.x, left.x), MulAdd(dt, velocity.y, left.y),
                            MulAdd(dt, velocity.z, left.z), here.w};
    next = {here.x + way.x, here.y + way.y, here.z + way.z, here.w};
    storeFloat4({way.x - (next.x - here.x), way.y - (next.y - here.y), way.z - (next.z - here.z), hn::Zero(d)}, kept);
  }
  storeFloat4(velocity, arrays.next_velocity + at.particle());
  storeFloat4(next, arrays.next_position + at.particle());

  const V speed_squared = MulAdd(velocity.x, velocity.x, MulAdd(velocity.y, velocity.y, velocity.z * velocity.z));
  fastest_squared = larger(fastest_squared, speed_squared);
  const bool moving = !hn::AllTrue(d, speed_squared <= set(now.rest_squared));
  std::uint8_t& any_moving = arrays.moving[at.group];
  any_moving = static_cast<std::uint8_t>(moving || (at.in_group > 0 && any_moving != 0));

  const Float4Vectors reference = loadFloat4(arrays.reference_position + at.particle());
  const V x = next.x - reference.x;
  const V y = next.y - reference.y;
  const V z = next.z - reference.z;
  const V squared = MulAdd(x, x, MulAdd(y, y, z * z));
  const V fraction = skinFraction(at.particle());
  const V limit = set(own.skin_half_squared) * fraction * fraction;
  const auto stays = squared <= limit;  // false for NaN
  if (!hn::AllTrue(d, stays)) {
    HWY_ALIGN float distances[hn::MaxLanes(D())];
    HWY_ALIGN float limits[hn::MaxLanes(D())];
    hn::Store(squared, d, distances);
    hn::Store(limit, d, limits);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      if (!(distances[lane] <= limits[lane])) {
        moved.particle[moved.count++] = static_cast<std::int32_t>(at.particle() + lane);
        moved.finite = moved.finite && distances[lane] <= 1e30F;
      }
    }
  }
}

/// A driven particle keeps its velocity, whatever pushes it.
HWY_INLINE Float4Vectors unlessDriven(const Float4Vectors& v, const Float4Vectors& wanted) {
  const auto driven = v.w != hn::Zero(D());
  return {hn::IfThenElse(driven, v.x, wanted.x), hn::IfThenElse(driven, v.y, wanted.y),
          hn::IfThenElse(driven, v.z, wanted.z), v.w};
}

/// Forces of neighbours, weight, tool and stones, N. Stores the neighbours' part if contact_force is not null.
HWY_INLINE Triple<V> forceWithoutWalls(const Sums& sums, const ClassConstants& own, const StepArrays& arrays,
                                       const Lanes& at) {
  if (arrays.contact_force != nullptr) {
    storeFloat4({sums.x, sums.y, sums.z, sums.repulsion}, arrays.contact_force + at.particle());
  }
  const Float4Vectors push = loadFloat4(arrays.external + at.particle());
  return {sums.x + (set(own.weight_x) + push.x), sums.y + (set(own.weight_y) + push.y),
          sums.z + (set(own.weight_z) + push.z)};
}

template <bool kPeriodic>
void icra2021In(const KernelLaw& law, const StepConstants& now, const StepBox& box, const StepArrays& arrays,
                std::size_t first, std::size_t last, Moved& moved) {
  const Icra2021Contacts contacts(law, box.periods, now.inner_skin_m);
  const D d;
  const V zero = hn::Zero(d);
  const V one = set(1);
  const V per_mass = set(now.dt * now.inverse_mass);
  const V half_width = set(box.half_width);
  const V half_length = set(box.half_length);
  const ClassConstants grain(now);
  V fastest_squared = zero;
  forEachVector(arrays, now.pruning_pass, first, last, [&](const Lanes& at) {
    const Float4Vectors x = loadFloat4(arrays.position + at.particle());
    const Float4Vectors v = loadFloat4(arrays.velocity + at.particle());
    Sums sums = contacts.sum<kPeriodic>(arrays, at, x);
    auto [fx, fy, fz] = forceWithoutWalls(sums, grain, arrays, at);
    contacts.addWall(x.z, one, fz, sums);
    if (box.walls_x) {
      contacts.addWall(half_width + x.x, one, fx, sums);
      contacts.addWall(half_width - x.x, zero - one, fx, sums);
    }
    if (box.walls_y) {
      contacts.addWall(half_length + x.y, one, fy, sums);
      contacts.addWall(half_length - x.y, zero - one, fy, sums);
    }

    // Semi-implicit: damping (paper 20) acts on the new velocity, so it can never overshoot.
    const V kept = Inverse(MulAdd(per_mass * set(now.damping), sums.contacts, one));
    const V vx = MulAdd(per_mass, fx, v.x) * kept;
    const V vy = MulAdd(per_mass, fy, v.y) * kept;
    const V vz = MulAdd(per_mass, fz, v.z) * kept;

    // Moving friction (paper 14, lower case) against the velocity; it stops the particle but never turns it round.
    const V huge = set(1e30F);  // clamped, so that friction cannot hide an infinite velocity
    const V speed_squared = smaller(MulAdd(vx, vx, MulAdd(vy, vy, MulAdd(vz, vz, set(1e-30F)))), huge);
    const V slowed_by = per_mass * set(now.moving_friction) * sums.repulsion;
    V left = larger(NegMulAdd(slowed_by, InverseSqrt(speed_squared), one), zero);

    // A particle at rest stays at rest up to the static limit (paper 14, upper case).
    const V limit = set(now.static_friction) * sums.repulsion;
    const auto at_rest = hn::And(hn::And(v.x == zero, v.y == zero), v.z == zero);
    const auto held = MulAdd(fx, fx, MulAdd(fy, fy, fz * fz)) <= limit * limit;
    left = hn::IfThenZeroElse(hn::And(at_rest, held), left);
    integrate(now, grain, arrays, at, x, unlessDriven(v, {vx * left, vy * left, vz * left, zero}), moved,
              fastest_squared);
  });
  moved.fastest_squared = hn::GetLane(hn::MaxOfLanes(d, fastest_squared));
}

template <bool kGraded, bool kPeriodic>
void contactFrictionIn(const GradedLaw& law, const StepConstants& now, const StepBox& box, const StepArrays& arrays,
                       std::size_t first, std::size_t last, Moved& moved) {
  PairLaws<kGraded> laws(law, now.dt, now.friction_ratio, now.inner_skin_m);
  const PeriodsOf periods(box.periods);
  const D d;
  const V zero = hn::Zero(d);
  const V one = set(1);
  const V drag = set(now.drag);
  const V ratio = set(box.wall_ratio);
  V fastest_squared = zero;
  forEachVector(arrays, now.pruning_pass, first, last, [&](const Lanes& at) {
    const Float4Vectors x = loadFloat4(arrays.position + at.particle());
    const Float4Vectors v = loadFloat4(arrays.velocity + at.particle());
    const GroupLaws contacts = laws.of(arrays, at.group);
    const PairLaw& own = contacts.own();
    const ClassConstants grain(now, kGraded ? arrays.grain_class[at.group] : 0);
    const V per_mass = set(now.dt * grain.inverse_mass);
    const Sums sums = frictionalSums<kGraded, kPeriodic, false>(contacts, periods, arrays, at, x, v);
    auto [fx, fy, fz] = forceWithoutWalls(sums, grain, arrays, at);
    WallSlips& slips = arrays.wall_slip[at.group];
    std::uint8_t& near = arrays.near_walls[at.group];
    const auto of = [&](std::array<float, kGroup>& slip) { return slip.data() + at.in_group; };
    const auto floor = own.wall(one,
                                {.distance = x.z - x.w,
                                 .away = v.z,
                                 .along_1 = v.x,
                                 .along_2 = v.y,
                                 .slip_1 = of(slips.floor_x),
                                 .slip_2 = of(slips.floor_y),
                                 .bit = kFloor},
                                near);
    fx = fx + floor.along_1;
    fy = fy + floor.along_2;
    fz = fz + floor.away;
    // The nearer of the two walls across an axis; `wall.away` is given as the velocity along the axis.
    const auto side_wall = [&](float half_m, V position, PairLaw::WallContact wall) HWY_ATTR {
      const V inwards = hn::IfThenElse(position < zero, one, zero - one);
      wall.distance = set(half_m) + inwards * position - x.w;
      wall.away = inwards * wall.away;
      auto force = own.wall(ratio, wall, near);
      force.away = inwards * force.away;
      return force;
    };
    if (box.walls_x) {
      const auto wall =
          side_wall(box.half_width, x.x, {zero, v.x, v.y, v.z, of(slips.x_wall_y), of(slips.x_wall_z), kWallX});
      fx = fx + wall.away;
      fy = fy + wall.along_1;
      fz = fz + wall.along_2;
    }
    if (box.walls_y) {
      const auto wall =
          side_wall(box.half_length, x.y, {zero, v.y, v.x, v.z, of(slips.y_wall_x), of(slips.y_wall_z), kWallY});
      fx = fx + wall.along_1;
      fy = fy + wall.away;
      fz = fz + wall.along_2;
    }
    const Float4Vectors next{MulAdd(per_mass, fx, v.x) * drag, MulAdd(per_mass, fy, v.y) * drag,
                             MulAdd(per_mass, fz, v.z) * drag, zero};
    integrate(now, grain, arrays, at, x, unlessDriven(v, next), moved, fastest_squared);
  });
  moved.fastest_squared = hn::GetLane(hn::MaxOfLanes(d, fastest_squared));
}

void icra2021(const KernelLaw& law, const StepConstants& now, const StepBox& box, const StepArrays& arrays,
              std::size_t first, std::size_t last, Moved& moved) {
  (box.periods.any() ? icra2021In<true> : icra2021In<false>)(law, now, box, arrays, first, last, moved);
}

void contactFriction(const GradedLaw& law, const StepConstants& now, const StepBox& box, const StepArrays& arrays,
                     std::size_t first, std::size_t last, Moved& moved) {
  const bool periodic = box.periods.any();
  const bool graded = arrays.grain_class != nullptr;
  (graded ? (periodic ? contactFrictionIn<true, true> : contactFrictionIn<true, false>)
          : (periodic ? contactFrictionIn<false, true> : contactFrictionIn<false, false>))(law, now, box, arrays, first,
                                                                                           last, moved);
}

// --- contacts alone --------------------------------------------------------------------------------------------------

void storeSums(const Sums& sums, ContactSum* out) {
  const D d;
  HWY_ALIGN float of[5][hn::MaxLanes(D())];
  hn::Store(sums.x, d, of[0]);
  hn::Store(sums.y, d, of[1]);
  hn::Store(sums.z, d, of[2]);
  hn::Store(sums.repulsion, d, of[3]);
  hn::Store(sums.contacts, d, of[4]);
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    out[lane] = {of[0][lane], of[1][lane], of[2][lane], of[3][lane], of[4][lane]};
  }
}

void icra2021Sums(const KernelLaw& law, const Periods& periods, const StepArrays& arrays, std::size_t first,
                  std::size_t last, ContactSum* sums) {
  const Icra2021Contacts contacts(law, periods, 0);
  forEachVector(arrays, 0, first, last, [&](const Lanes& at) {
    const Float4Vectors x = loadFloat4(arrays.position + at.particle());
    storeSums(contacts.sum<true>(arrays, at, x), sums + at.particle());
  });
}

template <bool kGraded>
void contactFrictionSumsOf(const GradedLaw& law, const Periods& box, float dt, const StepArrays& arrays,
                           std::size_t first, std::size_t last, ContactSum* sums) {
  PairLaws<kGraded> laws(law, dt, 1, 0);
  const PeriodsOf periods(box);
  forEachVector(arrays, 0, first, last, [&](const Lanes& at) {
    const Float4Vectors x = loadFloat4(arrays.position + at.particle());
    const Float4Vectors v = loadFloat4(arrays.velocity + at.particle());
    storeSums(frictionalSums<kGraded, true, true>(laws.of(arrays, at.group), periods, arrays, at, x, v),
              sums + at.particle());
  });
}

void contactFrictionSums(const GradedLaw& law, const Periods& periods, float dt, const StepArrays& arrays,
                         std::size_t first, std::size_t last, ContactSum* sums) {
  (arrays.grain_class != nullptr ? contactFrictionSumsOf<true> : contactFrictionSumsOf<false>)(law, periods, dt, arrays,
                                                                                               first, last, sums);
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace haptolith {

HWY_EXPORT(icra2021);
HWY_EXPORT(contactFriction);
HWY_EXPORT(icra2021Sums);
HWY_EXPORT(contactFrictionSums);

void stepWithIcra2021Friction(const KernelLaw& law, const StepConstants& now, const StepBox& box,
                              const StepArrays& arrays, std::size_t first, std::size_t last, Moved& moved) noexcept {
  HWY_DYNAMIC_DISPATCH(icra2021)(law, now, box, arrays, first, last, moved);
}

void stepWithContactFriction(const GradedLaw& law, const StepConstants& now, const StepBox& box,
                             const StepArrays& arrays, std::size_t first, std::size_t last, Moved& moved) noexcept {
  HWY_DYNAMIC_DISPATCH(contactFriction)(law, now, box, arrays, first, last, moved);
}

void sumContacts(const KernelLaw& law, const Periods& periods, const StepArrays& arrays, std::size_t first,
                 std::size_t last, ContactSum* sums) noexcept {
  HWY_DYNAMIC_DISPATCH(icra2021Sums)(law, periods, arrays, first, last, sums);
}

void sumFrictionalContacts(const GradedLaw& law, const Periods& periods, float dt_s, const StepArrays& arrays,
                           std::size_t first, std::size_t last, ContactSum* sums) noexcept {
  HWY_DYNAMIC_DISPATCH(contactFrictionSums)(law, periods, dt_s, arrays, first, last, sums);
}

}  // namespace haptolith
#endif  // HWY_ONCE

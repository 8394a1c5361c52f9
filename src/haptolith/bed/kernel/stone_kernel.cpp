#include "haptolith/bed/kernel/stone_kernel.h"

// This file is compiled once for every instruction set; the function at its end picks the best one at run time.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "haptolith/bed/kernel/stone_kernel.cpp"
#include <hwy/foreach_target.h>  // before highway.h
#include <hwy/highway.h>
#include "haptolith/bed/kernel/frictional_contacts-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

HWY_INLINE Triple<V> everywhere(const std::array<float, 3>& v) {
  return {set(v[0]), set(v[1]), set(v[2])};
}

HWY_INLINE Triple<V> minus(const Triple<V>& a, const Triple<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

HWY_INLINE Triple<V> times(V factor, const Triple<V>& v) {
  return {factor * v.x, factor * v.y, factor * v.z};
}

HWY_INLINE Triple<V> cross(const Triple<V>& a, const Triple<V>& b) {
  return {MulSub(a.y, b.z, a.z * b.y), MulSub(a.z, b.x, a.x * b.z), MulSub(a.x, b.y, a.y * b.x)};
}

HWY_INLINE Triple<V> chosen(hn::Mask<D> which, const Triple<V>& yes, const Triple<V>& no) {
  return {hn::IfThenElse(which, yes.x, no.x), hn::IfThenElse(which, yes.y, no.y), hn::IfThenElse(which, yes.z, no.z)};
}

/// Vectors in a stone's frame and in the scene's.
class Turn {
 public:
  explicit Turn(const std::array<std::array<float, 3>, 3>& scene_R_stone)
      : row_{everywhere(scene_R_stone[0]), everywhere(scene_R_stone[1]), everywhere(scene_R_stone[2])} {}

  [[nodiscard]] HWY_INLINE Triple<V> inStone(const Triple<V>& v) const {
    return {MulAdd(row_[0].x, v.x, MulAdd(row_[1].x, v.y, row_[2].x * v.z)),
            MulAdd(row_[0].y, v.x, MulAdd(row_[1].y, v.y, row_[2].y * v.z)),
            MulAdd(row_[0].z, v.x, MulAdd(row_[1].z, v.y, row_[2].z * v.z))};
  }
  [[nodiscard]] HWY_INLINE Triple<V> inScene(const Triple<V>& v) const {
    return {dot(row_[0], v), dot(row_[1], v), dot(row_[2], v)};
  }

 private:
  Triple<V> row_[3];
};

struct PackOverlap {
  V depth;  ///< negative: the gap
  Triple<V> towards;
  V steepness;
};

/// OverlapOfSpheres. Depths are in um on the way: their fourth powers in m would be lost.
HWY_INLINE PackOverlap overlapOf(const StoneBesidePack& stone, const Triple<V>& place, V own) {
  const D d;
  constexpr float kPerMetre = 1e6F;
  const V zero = hn::Zero(d);
  const V one = set(1);
  V nearest = set(-1e15F);
  Triple<V> nearest_towards{zero, zero, one};
  Triple<V> gradient{zero, zero, zero};
  V fourth = zero;
  for (const std::uint16_t number : stone.numbers) {
    const Float4& sphere = stone.spheres[number];
    const Triple<V> apart = minus(place, {set(sphere.x), set(sphere.y), set(sphere.z)});
    const V radii = set(sphere.w) + own;
    const V squared = larger(dot(apart, apart), set(1e-20F));  // coinciding centres also have a distance
    const V matters = radii - smaller(nearest, zero);
    if (hn::AllFalse(d, squared < matters * matters)) {
      continue;
    }
    const Distance distance = distanceOf(squared);
    const Triple<V> towards = times(distance.inverse, apart);
    const V depth = radii - distance.metres;
    const auto deeper = depth > nearest;
    nearest = hn::IfThenElse(deeper, depth, nearest);
    nearest_towards = chosen(deeper, towards, nearest_towards);
    const V inside = set(kPerMetre) * larger(depth, zero);
    const V cubed = inside * inside * inside;
    gradient = {MulAdd(cubed, towards.x, gradient.x), MulAdd(cubed, towards.y, gradient.y),
                MulAdd(cubed, towards.z, gradient.z)};
    fourth = MulAdd(cubed, inside, fourth);
  }
  const V depth = hn::Sqrt(hn::Sqrt(fourth));
  const V length = hn::Sqrt(dot(gradient, gradient));
  const auto several = hn::And(fourth > zero, length > zero);
  const V safe_length = hn::IfThenElse(several, length, one);
  const V safe_depth = hn::IfThenElse(several, depth, one);
  return {hn::IfThenElse(several, depth * set(1 / kPerMetre), nearest),
          chosen(several, times(one / safe_length, gradient), nearest_towards),
          hn::IfThenElse(several, length / (safe_depth * safe_depth * safe_depth), one)};
}

HWY_INLINE void store(const Triple<V>& v, std::array<std::array<float, kGroup>, 3>& to, std::size_t first) {
  const D d;
  hn::Store(v.x, d, to[0].data() + first);
  hn::Store(v.y, d, to[1].data() + first);
  hn::Store(v.z, d, to[2].data() + first);
}

void press(const StoneBesidePack& stone, const Float4* position, const Float4* velocity, StonePack& pack,
           PackTouch& touch) {
  const D d;
  const PairLaw law(stone.law, stone.dt_s, 1, 0);
  const Turn turn(stone.motion.scene_R_stone);
  const Triple<V> middle = everywhere(stone.motion.middle_m);
  const Triple<V> middle_rest = everywhere(stone.motion.middle_rest_m);
  const Triple<V> velocity_of_stone = everywhere(stone.motion.velocity_m_s);
  const Triple<V> spin = everywhere(stone.motion.spin_rad_s);
  for (std::size_t first = 0; first < kGroup; first += hn::Lanes(d)) {
    const Float4Vectors at = gatherFloat4(position, pack.particle.data() + first);
    const Float4Vectors v = gatherFloat4(velocity, pack.particle.data() + first);
    const Triple<V> place = turn.inStone(minus(minus({at.x, at.y, at.z}, middle), middle_rest));
    const V own = set(stone.grain_m) + at.w;
    const PackOverlap overlap = overlapOf(stone, place, own);
    const V a = law.diameter - overlap.depth;
    const auto touching = a < law.cutoff;
    hn::Store(a - law.cutoff, d, touch.beyond_m.data() + first);
    if (hn::AllFalse(d, touching)) {
      store({hn::Zero(d), hn::Zero(d), hn::Zero(d)}, pack.stretch_m, first);
      continue;
    }
    // All lines between the centres meet in the grain's: so does their sum's.
    const Triple<V>& n = overlap.towards;
    const Triple<V> lever = minus(place, times(NegMulAdd(set(0.5F), overlap.depth, own), n));
    const Triple<V> relative = minus(turn.inStone(minus({v.x, v.y, v.z}, velocity_of_stone)), cross(spin, lever));
    const V parting = dot(relative, n);
    const CohesiveContact<V> contact = cohesiveContact(law.law, law.cohesion, law.diameter, a);
    const V push = overlap.steepness * law.damped(contact.normal, a, overlap.steepness * parting);
    Triple<V> stretch{hn::Load(d, pack.stretch_m[0].data() + first), hn::Load(d, pack.stretch_m[1].data() + first),
                      hn::Load(d, pack.stretch_m[2].data() + first)};
    const Triple<V> drag =
        frictionForce(law.friction, touching, law.sliding_per_n * overlap.steepness * contact.compression, n,
                      minus(relative, times(parting, n)), stretch);
    store(stretch, pack.stretch_m, first);
    store(turn.inScene({MulAdd(push, n.x, drag.x), MulAdd(push, n.y, drag.y), MulAdd(push, n.z, drag.z)}),
          touch.force_n, first);
    store(turn.inScene(lever), touch.lever_m, first);
  }
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace haptolith {

StoneMotion::StoneMotion(const Vec3& middle, const Eigen::Matrix3d& rotation, const Vec3& velocity, const Vec3& spin) {
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    middle_m[k] = static_cast<float>(middle[i]);
    middle_rest_m[k] = static_cast<float>(middle[i] - double{middle_m[k]});
    velocity_m_s[k] = static_cast<float>(velocity[i]);
    spin_rad_s[k] = static_cast<float>(spin[i]);
    scene_R_stone[k] = {static_cast<float>(rotation(i, 0)), static_cast<float>(rotation(i, 1)),
                        static_cast<float>(rotation(i, 2))};
  }
}

HWY_EXPORT(press);

void pressPack(const StoneBesidePack& stone, const Float4* position, const Float4* velocity, StonePack& pack,
               PackTouch& touch) noexcept {
  HWY_DYNAMIC_DISPATCH(press)(stone, position, velocity, pack, touch);
}

}  // namespace haptolith
#endif  // HWY_ONCE

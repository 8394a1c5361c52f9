// Force of the neighbours on each particle with contact friction: repulsion, cohesion, damping, tangential springs.
// Included again for every target, therefore the toggled guard (Highway's idiom).
//
// A row is the s-th neighbour of each of 16 particles (ContactLists). It passes four stages:
//
//   stage            loads                 computes                              hands on
//   gather           positions x_j         x_i - x_j, sum of the size excesses   PairGeometry
//   relativeMotion   velocities v_j        distance a, normal n, v_i - v_j       PairMotion
//   normalForce      slips xi              F_n with damping, xi + v_t dt, limit  NormalContact
//   tangentialForce  -                     F_t; stores xi within the limit       Sums
//
// Each stage waits for the one before, and a row takes twice as long as a processor looks ahead. So frictionalSums()
// keeps three rows in flight: before the friction of one it has the motion of the next and the positions of the one
// after that.

#if defined(HAPTOLITH_FRICTIONAL_CONTACTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HAPTOLITH_FRICTIONAL_CONTACTS_INL_H_
#undef HAPTOLITH_FRICTIONAL_CONTACTS_INL_H_
#else
#define HAPTOLITH_FRICTIONAL_CONTACTS_INL_H_
#endif

#include <array>

#include "haptolith/bed/kernel/friction-inl.h"
#include "haptolith/bed/kernel/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

/// A vector of particles on its way through the rows of its group.
struct Group {
  Rows rows;
  const Float4Vectors &here, &velocity;
  const Lanes& at;
  std::size_t last_touched;  ///< found out when pruning
  Sums sums;
};

/// Separation of particles and their neighbours in a row.
struct PairGeometry {
  Separation separation;
  V excess;            ///< sum of both radii's excesses over the mean radius, m
  V neighbour_excess;  ///< m
};

struct PairMotion {
  Triple<V> normal, relative;  ///< n from the neighbour to the particle; v_i - v_j, m/s
  V a;                         ///< distance less the excess, m: what the contact law takes
};

struct NormalContact {
  Triple<V> normal, sliding, stretch;  ///< n; v_t, m/s; xi after sliding, m
  V a, push, reach;                    ///< m; F_n with damping, N; limit / k_t, m
};

/// Contact law between two particles, of one class or of two.
struct PairLaw {
  LawOf<V> law;
  CohesionOf<V> cohesion;
  FrictionOf<V> friction;
  V cutoff, inner_cutoff, diameter, damping;
  V sliding_per_n;     ///< mu_p / k_t: how far a spring can be stretched by what presses the two together, m/N
  V diameter_deficit;  ///< see ContactFrictionLaw

  PairLaw() = default;
  /// @param ratio  share of friction and cohesion that is switched on, 0 to 1.
  PairLaw(const ContactFrictionLaw& scalar, float dt, float ratio, float inner_skin_m)
      : law(lawOf(scalar.normal)),
        cohesion{set(ratio * scalar.cohesion), set(scalar.two_per_range), hn::Zero(D()), set(1)},
        friction{set(dt), set(-scalar.stiffness), set(scalar.lag)},
        cutoff(set(scalar.normal.cutoff)),
        inner_cutoff(set(scalar.normal.cutoff + inner_skin_m)),
        diameter(set(scalar.normal.diameter)),
        damping(set(scalar.damping)),
        sliding_per_n(set(ratio * scalar.friction / scalar.stiffness)),
        diameter_deficit(set(scalar.diameter_deficit)) {}

  /// Sets each constant that differs between pairs to what `of` makes of the one of `from`.
  template <class Of>
  HWY_INLINE void takeFrom(const PairLaw& from, const Of& of) {
    of(law.gamma, from.law.gamma);
    of(law.a_min, from.law.a_min);
    of(law.a_thr, from.law.a_thr);
    of(law.h, from.law.h);
    of(law.k, from.law.k);
    of(cohesion.largest, from.cohesion.largest);
    of(cohesion.two_per_range, from.cohesion.two_per_range);
    of(friction.minus_stiffness, from.friction.minus_stiffness);
    of(friction.lag, from.friction.lag);
    of(cutoff, from.cutoff);
    of(inner_cutoff, from.inner_cutoff);
    of(diameter, from.diameter);
    of(damping, from.damping);
    of(sliding_per_n, from.sliding_per_n);
    of(diameter_deficit, from.diameter_deficit);
  }

  /// Normal force with damping that dissipates in approach and separation, but never pulls:
  ///
  ///     F = max(F_n - c v_n, min(F_n, 0)),   c = zeta sqrt(2 m gamma) sqrt(-dF/da / gamma)
  ///
  /// c is zeta times the critical damping of the pair's stiffness -dF/da at `a` (rootOfStiffness()).
  /// @param normal  F_n, repulsion positive, N. @param parting  v_n, positive when separating, m/s.
  HWY_INLINE V damped(V normal, V a, V parting) const {
    const V with_damping = NegMulAdd(damping * rootOfStiffness(law, a), parting, normal);
    return larger(with_damping, smaller(normal, cohesion.zero));
  }

  struct PairDistance {
    V inverse, a;  ///< 1 / distance; distance of two particles of this law's mean size that overlap alike, m
  };
  template <bool kGraded>
  HWY_INLINE PairDistance distanceIn(const PairGeometry& pair) const {
    const Distance distance = distanceOf(pair.separation.squared);
    V a = distance.metres - pair.excess;
    if constexpr (kGraded) {
      a = a - diameter_deficit;
    }
    return {distance.inverse, a};
  }

  /// Whether any pair may be nearer than `limit`, without a root: rounding may add one that is not, and leaves out
  /// none.
  template <bool kGraded>
  HWY_INLINE bool mayBeWithin(const PairGeometry& pair, V limit) const {
    V distance = limit + pair.excess;
    if constexpr (kGraded) {
      distance = distance + diameter_deficit;
    }
    return !hn::AllFalse(D(), pair.separation.squared < distance * distance * set(1.00001F));
  }

  template <bool kGraded>
  HWY_INLINE PairMotion relativeMotion(Group& group, std::size_t row, const PairGeometry& pair) const {
    const D d;
    const Float4Vectors u = group.rows.velocities(row);
    group.rows.prefetchNextSlips(row);
    const PairDistance distance = distanceIn<kGraded>(pair);
    if (group.at.pruning != nullptr) {
      if (!hn::AllFalse(d, distance.a < inner_cutoff)) {
        keepInInnerList(group.at, row);
      }
      if (!hn::AllFalse(d, distance.a < cutoff)) {
        group.last_touched = row + 1;
      }
    }
    return {{pair.separation.x * distance.inverse, pair.separation.y * distance.inverse,
             pair.separation.z * distance.inverse},
            {group.velocity.x - u.x, group.velocity.y - u.y, group.velocity.z - u.z},
            distance.a};
  }

  template <bool kCompression>
  HWY_INLINE NormalContact normalForce(Group& group, std::size_t row, const PairMotion& pair) const {
    const D d;
    const float* HWY_RESTRICT slip = group.rows.slips(row);
    const Triple<V> stretch{hn::Load(d, slip), hn::Load(d, slip + kGroup), hn::Load(d, slip + 2 * kGroup)};
    const CohesiveContact<V> contact = cohesiveContact(law, cohesion, diameter, pair.a);
    if constexpr (kCompression) {
      group.sums.repulsion = group.sums.repulsion + hn::IfThenElseZero(pair.a < cutoff, contact.compression);
    }
    const V parting = dot(pair.relative, pair.normal);
    const Triple<V> sliding{NegMulAdd(parting, pair.normal.x, pair.relative.x),
                            NegMulAdd(parting, pair.normal.y, pair.relative.y),
                            NegMulAdd(parting, pair.normal.z, pair.relative.z)};
    return {pair.normal,
            sliding,
            stretched(friction, pair.normal, sliding, stretch),
            pair.a,
            damped(contact.normal, pair.a, parting),
            sliding_per_n * contact.compression};
  }

  HWY_INLINE void tangentialForce(Group& group, std::size_t row, const NormalContact& on) const {
    const D d;
    const auto touching = on.a < cutoff;
    Triple<V> stretch = on.stretch;
    const Triple<V> drag = heldFriction(friction, touching, on.reach, on.sliding, stretch);
    float* HWY_RESTRICT slip = group.rows.slips(row);
    hn::Store(stretch.x, d, slip);
    hn::Store(stretch.y, d, slip + kGroup);
    hn::Store(stretch.z, d, slip + 2 * kGroup);
    Sums& sums = group.sums;
    sums.x = sums.x + hn::IfThenElseZero(touching, MulAdd(on.push, on.normal.x, drag.x));
    sums.y = sums.y + hn::IfThenElseZero(touching, MulAdd(on.push, on.normal.y, drag.y));
    sums.z = sums.z + hn::IfThenElseZero(touching, MulAdd(on.push, on.normal.z, drag.z));
  }

  /// Particles next to a wall.
  struct WallContact {
    V distance;              ///< m
    V away;                  ///< velocity away from the wall, m/s
    V along_1, along_2;      ///< velocity along it, m/s
    float *slip_1, *slip_2;  ///< slips along it, m; read and written
    WallBit bit;
  };
  struct WallForce {
    V away, along_1, along_2;
  };
  /// Force of a wall: the particle's mirror image, which approaches as fast and does not slide.
  /// @param ratio  the wall's friction and cohesion over the soil's; cohesion keeps its range.
  HWY_INLINE WallForce wall(V ratio, const WallContact& at, std::uint8_t& near_walls) const {
    const D d;
    const V zero = hn::Zero(d);
    const V a = at.distance + at.distance - diameter_deficit;
    const auto near = a < cutoff;
    if (hn::AllFalse(d, near)) {
      if ((near_walls & at.bit) != 0) {
        hn::Store(zero, d, at.slip_1);
        hn::Store(zero, d, at.slip_2);
        if (hn::Lanes(d) == kGroup) {  // else the group's other vectors may remember
          near_walls = static_cast<std::uint8_t>(near_walls & ~at.bit);
        }
      }
      return {zero, zero, zero};
    }
    near_walls |= at.bit;
    CohesionOf<V> own = cohesion;
    own.largest = ratio * cohesion.largest;
    const CohesiveContact<V> contact = cohesiveContact(law, own, diameter, a);
    Triple<V> slip{hn::Load(d, at.slip_1), hn::Load(d, at.slip_2), zero};
    const Triple<V> drag = frictionForce(friction, near, ratio * sliding_per_n * contact.compression,
                                         {zero, zero, set(1)}, {at.along_1, at.along_2, zero}, slip);
    hn::Store(slip.x, d, at.slip_1);
    hn::Store(slip.y, d, at.slip_2);
    return {hn::IfThenElseZero(near, damped(contact.normal, a, at.away + at.away)), hn::IfThenElseZero(near, drag.x),
            hn::IfThenElseZero(near, drag.y)};
  }
};

/// Rows whose law is asked for at the same time.
constexpr std::size_t kRowsInFlight = 2;

/// Laws of grains of one class with all classes.
struct LawsOfClass {
  std::array<PairLaw, GrainClasses::kMost> with;
  PairLaw table;  ///< lane c holds what is between the class and class c
};

// A vector that has a lane for each class of grains is a table of them, which is asked with the classes of a row.
#if HWY_TARGET == HWY_SCALAR

using RowClasses = std::size_t;
HWY_INLINE RowClasses classesOf(const GrainClasses& classes, V excess) {
  return static_cast<std::size_t>(classes.of(hn::GetLane(excess)));
}
HWY_INLINE PairLaw lawWith(const LawsOfClass& laws, RowClasses classes) {
  return laws.with[classes];
}

#else

using RowClasses = decltype(hn::IndicesFromVec(D(), hn::Vec<hn::RebindToSigned<D> >()));
HWY_INLINE RowClasses classesOf(const GrainClasses& classes, V excess) {
  const hn::RebindToSigned<D> di;
  auto grain_class = hn::Zero(di);
  for (int c = 0; c + 1 < classes.count(); ++c) {
    const auto finer = hn::RebindMask(di, excess < set(classes.finerThan(c)));
    grain_class = hn::IfThenElse(finer, hn::Set(di, c + 1), grain_class);
  }
  return hn::IndicesFromVec(D(), grain_class);
}
/// All of the law is written here and little is wanted at each place that asks for it: the compiler looks up no more.
HWY_INLINE PairLaw lawWith(const LawsOfClass& laws, const RowClasses& classes) {
  PairLaw law = laws.table;
  law.takeFrom(laws.table, [&](V& one, V table) HWY_ATTR { one = hn::TableLookupLanes(table, classes); });
  return law;
}

#endif

/// Laws of a group's particles with their neighbours: those of their class and, in a graded bed, others.
class GroupLaws {
 public:
  GroupLaws(const GrainClasses& classes, const LawsOfClass& laws, std::size_t own)
      : classes_(classes), laws_(laws), own_(own) {}

  [[nodiscard]] HWY_INLINE const PairLaw& own() const { return laws_.with[own_]; }

  [[nodiscard]] HWY_INLINE RowClasses classesOf(V excess) const { return HWY_NAMESPACE::classesOf(classes_, excess); }
  /// Law between the group's class and those of a row; both sides of a pair get the same.
  [[nodiscard]] HWY_INLINE PairLaw with(const RowClasses& classes) const { return lawWith(laws_, classes); }

 private:
  const GrainClasses& classes_;
  const LawsOfClass& laws_;
  std::size_t own_;
};

/// Laws of every class with every class, at work; those of a class are made when it is first met.
template <bool kGraded>
class PairLaws {
 public:
  PairLaws(const GradedLaw& law, float dt, float ratio, float inner_skin_m)
      : law_(law), dt_(dt), ratio_(ratio), inner_skin_m_(inner_skin_m) {}

  [[nodiscard]] HWY_INLINE GroupLaws of(const StepArrays& arrays, std::size_t group) {
    const std::size_t own = kGraded ? arrays.grain_class[group] : 0;
    if (!made_[own]) {
      make(own);
      made_[own] = true;
    }
    return {law_.classes, laws_[own], own};
  }

 private:
  static constexpr std::size_t kClasses = kGraded ? GrainClasses::kMost : 1;

  [[nodiscard]] PairLaw between(std::size_t own, std::size_t other) const {
    return {law_.between[own][other], dt_, ratio_, inner_skin_m_};
  }

  void make(std::size_t own) {
    LawsOfClass& laws = laws_[own];
    for (std::size_t c = 0; c < kClasses; ++c) {
      laws.with[c] = between(own, c);
    }
    if constexpr (kGraded && HWY_TARGET != HWY_SCALAR) {
      const D d;
      laws.table = laws.with[0];
      for (std::size_t c = 1; c < kClasses; ++c) {
        const auto lane = hn::Iota(d, 0) == set(static_cast<float>(c));
        laws.table.takeFrom(laws.with[c],
                            [lane](V& table, V law_of_c) HWY_ATTR { table = hn::IfThenElse(lane, law_of_c, table); });
      }
    }
  }

  const GradedLaw& law_;
  float dt_, ratio_, inner_skin_m_;
  std::array<bool, kClasses> made_{};
  std::array<LawsOfClass, kClasses> laws_;
};

/// Laws of the rows in flight: in a graded bed each has its own.
template <bool kGraded>
class RowLaws {
 public:
  explicit RowLaws(const GroupLaws& laws) : laws_(laws) {}

  /// Law of a row that has just been gathered; row(row) returns it from then on.
  HWY_INLINE decltype(auto) row(std::size_t row, const PairGeometry& pair) {
    if constexpr (kGraded) {
      classes_[row % kRowsInFlight] = laws_.classesOf(pair.neighbour_excess);
    }
    return this->row(row);
  }
  [[nodiscard]] HWY_INLINE decltype(auto) row(std::size_t row) const {
    if constexpr (kGraded) {
      return laws_.with(classes_[row % kRowsInFlight]);
    } else {
      return laws_.own();
    }
  }

 private:
  const GroupLaws& laws_;
  std::array<RowClasses, kGraded ? kRowsInFlight : 0> classes_;
};

template <bool kPeriodic>
HWY_INLINE PairGeometry gather(const Group& group, const PeriodsOf& periods, std::size_t row) {
  const Float4Vectors there = group.rows.positions(row);
  group.rows.prefetchNextNeighbours(row);
  return {separationOf<kPeriodic>(periods, group.here, there), group.here.w + there.w, there.w};
}

/// Sum of the forces of all neighbours on each particle, N; advances the slips by one step. `kCompression`: also sums
/// what limits friction.
template <bool kGraded, bool kPeriodic, bool kCompression>
HWY_INLINE Sums frictionalSums(const GroupLaws& laws, const PeriodsOf& periods, const StepArrays& arrays,
                               const Lanes& at, const Float4Vectors& here, const Float4Vectors& v) {
  const D d;
  const V zero = hn::Zero(d);
  Group group{Rows(arrays, at), here, v, at, 0, {zero, zero, zero, zero, zero}};
  RowLaws<kGraded> of(laws);
  QuarterRows& touched = arrays.touched[at.group];
  // Behind those that touched, as most rows at the end of lists that have the nearest first, distances will do.
  std::size_t rows = HWY_MIN(rowsOf(touched, at.in_group), at.rows);
  for (std::size_t row = rows; row < at.rows; ++row) {
    const PairGeometry pair = gather<kPeriodic>(group, periods, row);
    const auto& law = of.row(row, pair);
    if (at.pruning != nullptr && law.template mayBeWithin<kGraded>(pair, law.inner_cutoff)) {
      keepInInnerList(at, row);
    }
    rows = law.template mayBeWithin<kGraded>(pair, law.cutoff) ? row + 1 : rows;
  }
  if (rows == 0) {
    return group.sums;
  }
  const auto gathered = [&](std::size_t row)
                            HWY_ATTR { return gather<kPeriodic>(group, periods, HWY_MIN(row, rows - 1)); };
  PairGeometry pair = gathered(0);
  PairMotion motion = of.row(0, pair).template relativeMotion<kGraded>(group, 0, pair);
  pair = gathered(1);
  for (std::size_t row = 0; row + 1 < rows; ++row) {
    const NormalContact contact = of.row(row).template normalForce<kCompression>(group, row, motion);
    motion = of.row(row + 1, pair).template relativeMotion<kGraded>(group, row + 1, pair);
    pair = gathered(row + 2);
    of.row(row).tangentialForce(group, row, contact);
  }
  const PairLaw& last = of.row(rows - 1);
  last.tangentialForce(group, rows - 1, last.template normalForce<kCompression>(group, rows - 1, motion));
  const std::size_t now_touched = at.pruning != nullptr ? group.last_touched : rows;
  setRows(touched, at.in_group, hn::Lanes(d) >= 4 ? now_touched : HWY_MAX(now_touched, rowsOf(touched, at.in_group)));
  return group.sums;
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

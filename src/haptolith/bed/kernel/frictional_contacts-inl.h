// What a particle feels of its neighbours by contact friction: cohesion, damping, and springs that remember. Included
// again for every target, hence the toggled guard (Highway's idiom).

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
  const Records &here, &velocity;
  const Lanes& at;
  std::size_t last_touched;  ///< found out when looking
  Sums sums;
};

/// A particle and its neighbour in a row.
struct Met {
  Apart way;
  V excess;  ///< of both together
  V theirs;
};

struct Near {
  Triple<V> towards, relative;  ///< direction and velocity from the neighbour
  V a;
};

struct Pressed {
  Triple<V> towards, sliding, stretch;
  V a, push, reach;
};

/// What is between two grains that touch, of one class or of two.
struct PairLaw {
  LawOf<V> law;
  CohesionOf<V> cohesion;
  FrictionOf<V> friction;
  V cutoff, near_limit, diameter, damping;
  V sliding_per_n;  ///< mu_p / k_t: how far a spring can be stretched by what presses the two together, m/N
  V nearer;         ///< see ContactFrictionLaw

  PairLaw() = default;
  /// As it is at work: `ratio` is how much of friction and cohesion is switched on.
  PairLaw(const ContactFrictionLaw& scalar, float dt, float ratio, float near_m)
      : law(lawOf(scalar.normal)),
        cohesion{set(ratio * scalar.cohesion), set(scalar.two_per_range), hn::Zero(D()), set(1)},
        friction{set(dt), set(-scalar.stiffness), set(scalar.lag), set(1), set(1e-30F)},
        cutoff(set(scalar.normal.cutoff)),
        near_limit(set(scalar.normal.cutoff + near_m)),
        diameter(set(scalar.normal.diameter)),
        damping(set(scalar.damping)),
        sliding_per_n(set(ratio * scalar.friction / scalar.stiffness)),
        nearer(set(scalar.nearer)) {}

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
    of(near_limit, from.near_limit);
    of(diameter, from.diameter);
    of(damping, from.damping);
    of(sliding_per_n, from.sliding_per_n);
    of(nearer, from.nearer);
  }

  /// Damping takes energy from approach and parting alike, but never pulls.
  HWY_INLINE V damped(V normal, V a, V parting) const {
    const V with_damping = hn::NegMulAdd(damping * rootOfStiffness(law, a), parting, normal);
    return hn::Max(with_damping, hn::Min(normal, cohesion.zero));
  }

  struct Between {
    V inverse, a;  ///< of the distance; as far as two particles of this law's mean size would be
  };
  template <bool kGraded>
  HWY_INLINE Between distanceIn(const Met& met) const {
    const Distance distance = distanceOf(met.way.squared);
    V a = distance.metres - met.excess;
    if constexpr (kGraded) {
      a = a - nearer;
    }
    return {distance.inverse, a};
  }

  template <bool kGraded>
  HWY_INLINE Near approach(Group& group, std::size_t row, const Met& met) const {
    const D d;
    const Records u = group.rows.velocities(row);
    group.rows.askForNextSlips(row);
    const Between between = distanceIn<kGraded>(met);
    if (group.at.looking != nullptr) {
      if (!hn::AllFalse(d, between.a < near_limit)) {
        noteNear(group.at, row);
      }
      if (!hn::AllFalse(d, between.a < cutoff)) {
        group.last_touched = row + 1;
      }
    }
    return {{met.way.x * between.inverse, met.way.y * between.inverse, met.way.z * between.inverse},
            {group.velocity.x - u.x, group.velocity.y - u.y, group.velocity.z - u.z},
            between.a};
  }

  template <bool kCompression>
  HWY_INLINE Pressed press(Group& group, std::size_t row, const Near& near) const {
    const D d;
    const float* HWY_RESTRICT slip = group.rows.slips(row);
    const Triple<V> stretch{hn::Load(d, slip), hn::Load(d, slip + kGroup), hn::Load(d, slip + 2 * kGroup)};
    const CohesiveContact<V> contact = cohesiveContact(law, cohesion, diameter, near.a);
    if constexpr (kCompression) {
      group.sums.repulsion = group.sums.repulsion + hn::IfThenElseZero(near.a < cutoff, contact.compression);
    }
    const V parting = dot(near.relative, near.towards);
    const Triple<V> sliding{hn::NegMulAdd(parting, near.towards.x, near.relative.x),
                            hn::NegMulAdd(parting, near.towards.y, near.relative.y),
                            hn::NegMulAdd(parting, near.towards.z, near.relative.z)};
    return {near.towards,
            sliding,
            stretched(friction, near.towards, sliding, stretch),
            near.a,
            damped(contact.normal, near.a, parting),
            sliding_per_n * contact.compression};
  }

  HWY_INLINE void rub(Group& group, std::size_t row, const Pressed& on) const {
    const D d;
    const auto touching = on.a < cutoff;
    Triple<V> stretch = on.stretch;
    const Triple<V> drag = heldFriction(friction, on.reach, on.sliding, stretch,
                                        [&](V xi) HWY_ATTR { return hn::IfThenElseZero(touching, xi); });
    float* HWY_RESTRICT slip = group.rows.slips(row);
    hn::Store(stretch.x, d, slip);
    hn::Store(stretch.y, d, slip + kGroup);
    hn::Store(stretch.z, d, slip + 2 * kGroup);
    Sums& sums = group.sums;
    sums.x = sums.x + hn::IfThenElseZero(touching, hn::MulAdd(on.push, on.towards.x, drag.x));
    sums.y = sums.y + hn::IfThenElseZero(touching, hn::MulAdd(on.push, on.towards.y, drag.y));
    sums.z = sums.z + hn::IfThenElseZero(touching, hn::MulAdd(on.push, on.towards.z, drag.z));
  }

  /// Particles against a wall: `distance` to it, velocity away from it and along it; what they have slid so far.
  struct Touch {
    V distance, away, along_1, along_2;
    float *slip_1, *slip_2;
    std::uint8_t bit;  ///< of the wall, in StepArrays::near_walls
  };
  struct WallForce {
    V away, along_1, along_2;
  };
  /// The wall is the particle's mirror image, which comes as fast as it goes, and does not slide. `ratio` is its
  /// friction and cohesion over the soil's; its cohesion does not change how far it reaches.
  HWY_INLINE WallForce wall(V ratio, const Touch& touch, std::uint8_t& near_walls) const {
    const D d;
    const V zero = hn::Zero(d);
    const V a = touch.distance + touch.distance - nearer;
    const auto near = a < cutoff;
    if (hn::AllFalse(d, near)) {
      if ((near_walls & touch.bit) != 0) {
        hn::Store(zero, d, touch.slip_1);
        hn::Store(zero, d, touch.slip_2);
        if (hn::Lanes(d) == kGroup) {  // else the group's other vectors may remember
          near_walls = static_cast<std::uint8_t>(near_walls & ~touch.bit);
        }
      }
      return {zero, zero, zero};
    }
    near_walls |= touch.bit;
    CohesionOf<V> own = cohesion;
    own.largest = ratio * cohesion.largest;
    const CohesiveContact<V> contact = cohesiveContact(law, own, diameter, a);
    Triple<V> slip{hn::Load(d, touch.slip_1), hn::Load(d, touch.slip_2), zero};
    const Triple<V> drag = frictionForce(friction, ratio * sliding_per_n * contact.compression, {zero, zero, set(1)},
                                         {touch.along_1, touch.along_2, zero}, slip);
    hn::Store(hn::IfThenElseZero(near, slip.x), d, touch.slip_1);
    hn::Store(hn::IfThenElseZero(near, slip.y), d, touch.slip_2);
    return {hn::IfThenElseZero(near, damped(contact.normal, a, touch.away + touch.away)),
            hn::IfThenElseZero(near, drag.x), hn::IfThenElseZero(near, drag.y)};
  }
};

/// Rows whose contacts are worked out at once, see frictionalSums().
constexpr std::size_t kRowsUnderWay = 4;

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

/// Laws of a group's grains with their neighbours: those of their own class and, in a graded bed, others.
class GroupLaws {
 public:
  GroupLaws(const GrainClasses& classes, const LawsOfClass& laws, std::size_t own)
      : classes_(classes), laws_(laws), own_(own) {}

  [[nodiscard]] HWY_INLINE const PairLaw& own() const { return laws_.with[own_]; }

  [[nodiscard]] HWY_INLINE RowClasses classesOf(V excess) const { return HWY_NAMESPACE::classesOf(classes_, excess); }
  /// What is between the group's class and those of a row; a pair comes out the same from both sides.
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
  PairLaws(const GradedLaw& law, float dt, float ratio, float near_m)
      : law_(law), dt_(dt), ratio_(ratio), near_m_(near_m) {}

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
    return {law_.between[own][other], dt_, ratio_, near_m_};
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
  float dt_, ratio_, near_m_;
  std::array<bool, kClasses> made_{};
  std::array<LawsOfClass, kClasses> laws_;
};

/// Laws of the rows that are under way: in a graded bed each has its own.
template <bool kGraded>
class RowLaws {
 public:
  explicit RowLaws(const GroupLaws& laws) : laws_(laws) {}

  /// Of a row that has just been met, and from then on.
  HWY_INLINE decltype(auto) row(std::size_t row, const Met& met) {
    if constexpr (kGraded) {
      classes_[row % kRowsUnderWay] = laws_.classesOf(met.theirs);
    }
    return this->row(row);
  }
  [[nodiscard]] HWY_INLINE decltype(auto) row(std::size_t row) const {
    if constexpr (kGraded) {
      return laws_.with(classes_[row % kRowsUnderWay]);
    } else {
      return laws_.own();
    }
  }

 private:
  const GroupLaws& laws_;
  std::array<RowClasses, kGraded ? kRowsUnderWay : 0> classes_;
};

template <bool kPeriodic>
HWY_INLINE Met meet(const Group& group, const PeriodsOf& periods, std::size_t row) {
  const Records there = group.rows.positions(row);
  group.rows.askForNextOthers(row);
  return {apart<kPeriodic>(periods, group.here, there), group.here.w + there.w, there.w};
}

/// All neighbours, friction included; their memory moves on. What limits friction is summed only for who asks.
///
/// A row is one long chain in which each step waits for the one before: twice as long as the processor looks ahead.
/// So four rows are under way at once, each a quarter of its work behind the next.
template <bool kGraded, bool kPeriodic, bool kCompression>
HWY_INLINE Sums frictionalSums(const GroupLaws& laws, const PeriodsOf& periods, const StepArrays& arrays,
                               const Lanes& at, const Records& here, const Records& v) {
  const D d;
  const V zero = hn::Zero(d);
  Group group{Rows(arrays, at), here, v, at, 0, {zero, zero, zero, zero, zero}};
  RowLaws<kGraded> of(laws);
  std::uint16_t& touched = arrays.touched[at.group];
  // Behind those that touched, as most rows at the end of lists that have the nearest first, distances will do.
  std::size_t rows = HWY_MIN(std::size_t{touched}, at.rows);
  for (std::size_t row = rows; row < at.rows; ++row) {
    const Met met = meet<kPeriodic>(group, periods, row);
    const auto& law = of.row(row, met);
    const V a = law.template distanceIn<kGraded>(met).a;
    if (at.looking != nullptr && !hn::AllFalse(d, a < law.near_limit)) {
      noteNear(at, row);
    }
    rows = hn::AllFalse(d, a < law.cutoff) ? rows : row + 1;
  }
  if (rows == 0) {
    return group.sums;
  }
  rows = HWY_MAX(rows, std::size_t{3});  // there is room for them, if with ghosts only
  Met met = meet<kPeriodic>(group, periods, 0);
  Near near = of.row(0, met).template approach<kGraded>(group, 0, met);
  met = meet<kPeriodic>(group, periods, 1);
  Pressed pressed = of.row(0).template press<kCompression>(group, 0, near);
  near = of.row(1, met).template approach<kGraded>(group, 1, met);
  met = meet<kPeriodic>(group, periods, 2);
  for (std::size_t row = 3; row < rows; ++row) {
    of.row(row - 3).rub(group, row - 3, pressed);
    pressed = of.row(row - 2).template press<kCompression>(group, row - 2, near);
    near = of.row(row - 1, met).template approach<kGraded>(group, row - 1, met);
    met = meet<kPeriodic>(group, periods, row);
  }
  of.row(rows - 3).rub(group, rows - 3, pressed);
  pressed = of.row(rows - 2).template press<kCompression>(group, rows - 2, near);
  near = of.row(rows - 1, met).template approach<kGraded>(group, rows - 1, met);
  of.row(rows - 2).rub(group, rows - 2, pressed);
  pressed = of.row(rows - 1).template press<kCompression>(group, rows - 1, near);
  of.row(rows - 1).rub(group, rows - 1, pressed);
  const std::size_t now_touched = at.looking != nullptr ? group.last_touched : rows;
  // Where a group is several vectors, the others' rows stay noted.
  touched = static_cast<std::uint16_t>(hn::Lanes(d) == kGroup ? now_touched : HWY_MAX(now_touched, touched));
  return group.sums;
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

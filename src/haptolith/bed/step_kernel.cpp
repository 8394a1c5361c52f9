#include "haptolith/bed/step_kernel.h"

#include <hwy/cache_control.h>

#include <array>
#include <utility>

// This file is compiled once for every instruction set; the functions at its end pick the best one at run time.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "haptolith/bed/step_kernel.cpp"
#include <hwy/foreach_target.h>  // before highway.h
#include <hwy/highway.h>
#include "haptolith/bed/friction-inl.h"
#include "haptolith/bed/records-inl.h"
#include "haptolith/soil/contact_law-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

// Highway's dispatch tables take no noexcept functions; the public ones below are.

HWY_INLINE V set(float value) {
  return hn::Set(D(), value);
}

/// Where in the arrays a vector of particles stands: 16 particles are a group, one vector of AVX-512 or several.
struct Lanes {
  std::size_t group, in_group, next_group;
  std::size_t rows;   // to go through
  NearRows* looking;  // where to note which of them have somebody near; null: that is known
  [[nodiscard]] std::size_t particle() const { return group * kGroup + in_group; }
};

/// The rows of a group and of the one after it. While one is worked on the other is asked for, a row at a time: lists
/// are longer than processors look ahead, and large beds lie in memory far slower than the kernel is.
class Rows {
 public:
  Rows(const StepArrays& arrays, const Lanes& at)
      : other_(arrays.other + arrays.first_row[at.group] * kGroup + at.in_group),
        next_other_(arrays.other + arrays.first_row[at.next_group] * kGroup),
        slip_(arrays.slip + arrays.first_row[at.group] * 3 * kGroup + at.in_group),
        next_slip_(arrays.slip + arrays.first_row[at.next_group] * 3 * kGroup),
        position_(arrays.position),
        velocity_(arrays.velocity) {}

  /// Records of a row's neighbours.
  [[nodiscard]] HWY_INLINE Records positions(std::size_t row) const {
    return loadRecords(position_, other_ + row * kGroup);
  }
  [[nodiscard]] HWY_INLINE Records velocities(std::size_t row) const {
    return loadRecords(velocity_, other_ + row * kGroup);
  }
  /// x of a row; y and z stand kGroup and 2 kGroup behind.
  [[nodiscard]] HWY_INLINE float* slips(std::size_t row) const { return slip_ + row * 3 * kGroup; }
  HWY_INLINE void askForNextOthers(std::size_t row) const { hwy::Prefetch(next_other_ + row * kGroup); }
  HWY_INLINE void askForNextSlips(std::size_t row) const {
    const float* slip = next_slip_ + row * 3 * kGroup;
    hwy::Prefetch(slip);
    hwy::Prefetch(slip + kGroup);
    hwy::Prefetch(slip + 2 * kGroup);
  }

 private:
  const std::uint32_t *other_, *next_other_;
  float *slip_, *next_slip_;
  const Float4 *position_, *velocity_;
};

/// Calls `each(lanes)` for all vectors of particles of groups[first..last-1], or of groups first..last-1. Groups that
/// have not looked who is near do so.
template <class Each>
HWY_INLINE void forEachVector(const StepArrays& arrays, std::uint64_t look, std::size_t first, std::size_t last,
                              const Each& each) {
  for (std::size_t k = first; k < last; ++k) {
    const std::size_t group = arrays.groups != nullptr ? arrays.groups[k] : k;
    const std::size_t next = arrays.groups != nullptr ? arrays.groups[k + 1] : k + 1;
    NearRows* const near = arrays.near != nullptr ? arrays.near + group : nullptr;
    const bool known = near != nullptr && near->look == look;
    Lanes at{group, 0, next, known ? near->rows : arrays.rows[group], known ? nullptr : near};
    if (at.looking != nullptr) {
      *near = {look, 0};
    }
    for (; at.in_group < kGroup; at.in_group += hn::Lanes(D())) {
      each(at);
    }
  }
}

/// Notes that a row has somebody near.
HWY_INLINE void noteNear(const Lanes& at, std::size_t row) {
  at.looking->rows = HWY_MAX(at.looking->rows, static_cast<std::uint32_t>(row + 1));
}

/// A distance and its inverse from its square, the distance to the last bit but one, for the law magnifies its error:
/// Goldschmidt's step from the processor's first guess, and one more for the distance where that has 12 bits only.
struct Distance {
  V metres, inverse;
};
HWY_INLINE Distance distanceOf(V squared) {
  const V half = set(0.5F);
  const V guess = hn::ApproximateReciprocalSqrt(squared);
  V metres = squared * guess;
  V half_inverse = guess * half;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const V error = hn::NegMulAdd(metres, half_inverse, half);
    metres = hn::MulAdd(metres, error, metres);
    half_inverse = hn::MulAdd(half_inverse, error, half_inverse);
  }
  constexpr bool kGoodGuess = HWY_TARGET <= HWY_AVX3 || HWY_ARCH_ARM;  // better targets have smaller numbers
  if constexpr (!kGoodGuess) {
    metres = hn::MulAdd(hn::NegMulAdd(metres, metres, squared), half_inverse, metres);
  }
  return {metres, half_inverse + half_inverse};
}

struct PeriodsOf {
  V width, length, per_width, per_length;
  explicit PeriodsOf(const Periods& p)
      : width(set(p.width)), length(set(p.length)), per_width(set(p.per_width)), per_length(set(p.per_length)) {}
};

/// From neighbours to particles: where they are, and how far that is.
struct Apart {
  V x, y, z, squared;
};
template <bool kPeriodic>
HWY_INLINE Apart apart(const PeriodsOf& periods, const Records& here, const Records& other) {
  const V x = nearestImage<kPeriodic>(here.x - other.x, periods.width, periods.per_width);
  const V y = nearestImage<kPeriodic>(here.y - other.y, periods.length, periods.per_length);
  const V z = here.z - other.z;
  const V tiny = set(1e-24F);  // two centres in one point repel nowhere, instead of 0/0
  return {x, y, z, hn::MulAdd(x, x, hn::MulAdd(y, y, hn::MulAdd(z, z, tiny)))};
}

/// What particles feel of their neighbours.
struct Sums {
  V x, y, z, repulsion, contacts;
};

LawOf<V> lawOf(const KernelLaw& law) {
  return {set(law.gamma), set(law.a_min), set(law.a_thr), set(law.h), set(law.k)};
}

// --- the paper's friction --------------------------------------------------------------------------------------------

struct PaperContacts {
  LawOf<V> law;
  V cutoff, near_limit, diameter;
  PeriodsOf periods;

  PaperContacts(const KernelLaw& scalar, const Periods& box, float near_m)
      : law(lawOf(scalar)),
        cutoff(set(scalar.cutoff)),
        near_limit(set(scalar.cutoff + near_m)),
        diameter(set(scalar.diameter)),
        periods(box) {}

  /// (paper 19) over all neighbours. While one row's forces are worked out, the next row's particles are fetched
  /// already: either alone is a long chain in which each step waits for the one before.
  template <bool kPeriodic>
  HWY_INLINE Sums sum(const StepArrays& arrays, const Lanes& at, const Records& here) const {
    const V zero = hn::Zero(D());
    const V one = set(1);
    Sums sums{zero, zero, zero, zero, zero};
    const Rows rows(arrays, at);
    const auto fetch = [&](std::size_t row) { return apart<kPeriodic>(periods, here, rows.positions(row)); };
    Apart next = fetch(0);  // there is room for a row, if with ghosts only
    for (std::size_t row = 0; row < at.rows; ++row) {
      const Apart d = next;
      next = fetch(row + 1 < at.rows ? row + 1 : row);
      rows.askForNextOthers(row);
      const Distance a = distanceOf(d.squared);
      if (at.looking != nullptr && !hn::AllFalse(D(), a.metres < near_limit)) {
        noteNear(at, row);
      }
      const V force = hn::IfThenElseZero(a.metres < cutoff, uncutContactForce(law, a.metres));
      const V per_metre = force * a.inverse;
      sums.x = hn::MulAdd(per_metre, d.x, sums.x);
      sums.y = hn::MulAdd(per_metre, d.y, sums.y);
      sums.z = hn::MulAdd(per_metre, d.z, sums.z);
      sums.repulsion = sums.repulsion + hn::Max(force, zero);
      sums.contacts = sums.contacts + hn::IfThenElseZero(a.metres < diameter, one);
    }
    return sums;
  }

  /// Adds the push of a wall at `distance` along one axis; `sign` is the axis's direction away from the wall. The wall
  /// is the particle's mirror image (see wallLaw()) and, like any macroparticle, counts for friction and damping.
  HWY_INLINE void addWall(V distance, V sign, V& force, Sums& sums) const {
    const V a = distance + distance;
    const auto touches = a < diameter;
    if (hn::AllFalse(D(), touches)) {
      return;
    }
    const V push = hn::IfThenElseZero(touches, uncutContactForce(law, a));
    force = hn::MulAdd(sign, push, force);
    sums.repulsion = sums.repulsion + push;
    sums.contacts = sums.contacts + hn::IfThenElseZero(touches, set(1));
  }
};

// --- contact friction ------------------------------------------------------------------------------------------------

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

/// Whether a vector has a lane for each class of grains: then it is a table.
constexpr bool kIsTable = HWY_TARGET != HWY_SCALAR;

/// Laws of grains of one class with all classes.
struct LawsOfClass {
  std::array<PairLaw, GrainClasses::kMost> with;
  PairLaw table;  ///< where a vector is one: lane c holds what is between the class and class c
};

/// Laws of a group's grains with their neighbours: those of their own class and, in a graded bed, others.
template <bool kGraded>
class GroupLaws {
 public:
  GroupLaws(const GrainClasses& classes, const LawsOfClass& laws, int own)
      : classes_(classes), laws_(laws), own_(own) {}

  [[nodiscard]] HWY_INLINE const PairLaw& own() const { return laws_.with[static_cast<std::size_t>(own_)]; }

  /// The law of a row of neighbours: the group's own, or where there are others among them `mixed`, made of what is
  /// between the group's class and each one's. Either way a pair comes out the same from both sides.
  HWY_INLINE const PairLaw& ofRow(V excess, V squared, PairLaw& mixed) const {
    if constexpr (kGraded) {
      auto other = excess < set(classes_.finerThan(own_));
      if (own_ > 0) {
        other = hn::Or(other, excess >= set(classes_.finerThan(own_ - 1)));
      }
      if (!hn::AllFalse(D(), hn::And(other, squared < set(kGhostsFrom_m2)))) {
        mix(excess, mixed);
        return mixed;
      }
    }
    return own();
  }

 private:
  static constexpr float kGhostsFrom_m2 = 1e12F;

  HWY_INLINE void mix(V excess, PairLaw& mixed) const {
    if constexpr (kIsTable) {
      const hn::RebindToSigned<D> di;
      auto grain_class = hn::Zero(di);
      for (int c = 0; c + 1 < classes_.count(); ++c) {
        const auto finer = hn::RebindMask(di, excess < set(classes_.finerThan(c)));
        grain_class = hn::IfThenElse(finer, hn::Set(di, c + 1), grain_class);
      }
      const auto indices = hn::IndicesFromVec(D(), grain_class);
      mixed.takeFrom(laws_.table, [&](V& own, V table) HWY_ATTR { own = hn::TableLookupLanes(table, indices); });
    } else {
      mixed = laws_.with[0];
      for (int c = 1; c < classes_.count(); ++c) {
        const auto here = excess < set(classes_.finerThan(c - 1));
        mixed.takeFrom(laws_.with[static_cast<std::size_t>(c)],
                       [&](V& own, V theirs) HWY_ATTR { own = hn::IfThenElse(here, theirs, own); });
      }
    }
  }

  const GrainClasses& classes_;
  const LawsOfClass& laws_;
  int own_;
};

/// Laws of every class with every class, at work.
template <bool kGraded>
class PairLaws {
 public:
  PairLaws(const GradedLaw& law, float dt, float ratio, float near_m)
      : classes_(law.classes), laws_(make(law, {dt, ratio, near_m}, std::make_index_sequence<kClasses>())) {
    if constexpr (kGraded && kIsTable) {
      for (LawsOfClass& own : laws_) {
        for (std::size_t c = 0; c < GrainClasses::kMost; ++c) {
          own.table.takeFrom(own.with[c], [c](V& table, V law_of_c)
                                              HWY_ATTR { table = hn::InsertLane(table, c, hn::GetLane(law_of_c)); });
        }
      }
    }
  }

  [[nodiscard]] HWY_INLINE GroupLaws<kGraded> of(const StepArrays& arrays, std::size_t group) const {
    const std::size_t own = kGraded ? arrays.grain_class[group] : 0;
    return {classes_, laws_[own], static_cast<int>(own)};
  }

  /// For the rows that are under way at once.
  [[nodiscard]] std::array<PairLaw, kRowsUnderWay> roomForMixed() const {
    const PairLaw& any = laws_[0].with[0];
    return {any, any, any, any};
  }

 private:
  static constexpr std::size_t kClasses = kGraded ? GrainClasses::kMost : 1;
  using Laws = std::array<LawsOfClass, kClasses>;
  struct AtWork {
    float dt, ratio, near_m;
  };
  static LawsOfClass makeOne(const std::array<ContactFrictionLaw, GrainClasses::kMost>& with, const AtWork& now) {
    const auto of = [&](std::size_t c) { return PairLaw(with[kGraded ? c : 0], now.dt, now.ratio, now.near_m); };
    return {{of(0), of(1), of(2), of(3)}, of(0)};
  }
  template <std::size_t... kIndex>
  static Laws make(const GradedLaw& law, const AtWork& now, std::index_sequence<kIndex...> /*all*/) {
    return {makeOne(law.between[kIndex], now)...};
  }

  const GrainClasses& classes_;
  Laws laws_;
};

/// Laws of the rows that are under way: in a graded bed each has its own.
template <bool kGraded>
class RowLaws {
 public:
  /// @param mixed  room for kRowsUnderWay laws, which begin as any.
  RowLaws(const GroupLaws<kGraded>& laws, PairLaw* mixed) : laws_(laws), mixed_(mixed) {}

  /// Of a row that has just been met, and from then on.
  HWY_INLINE const PairLaw& row(std::size_t row, const Met& met) {
    if constexpr (kGraded) {
      const std::size_t place = row % kRowsUnderWay;
      law_[place] = &laws_.ofRow(met.theirs, met.way.squared, mixed_[place]);
    }
    return this->row(row);
  }
  [[nodiscard]] HWY_INLINE const PairLaw& row(std::size_t row) const {
    if constexpr (kGraded) {
      return *law_[row % kRowsUnderWay];
    }
    return laws_.own();
  }

 private:
  const GroupLaws<kGraded>& laws_;
  std::array<const PairLaw*, kRowsUnderWay> law_{};
  PairLaw* mixed_;
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
HWY_INLINE Sums frictionalSums(const GroupLaws<kGraded>& laws, const PeriodsOf& periods, const StepArrays& arrays,
                               const Lanes& at, const Records& here, const Records& v, PairLaw* mixed) {
  const D d;
  const V zero = hn::Zero(d);
  Group group{Rows(arrays, at), here, v, at, 0, {zero, zero, zero, zero, zero}};
  RowLaws<kGraded> of(laws, mixed);
  std::uint16_t& touched = arrays.touched[at.group];
  // Behind those that touched, as most rows at the end of lists that have the nearest first, distances will do.
  std::size_t rows = HWY_MIN(std::size_t{touched}, at.rows);
  for (std::size_t row = rows; row < at.rows; ++row) {
    const Met met = meet<kPeriodic>(group, periods, row);
    const PairLaw& law = of.row(row, met);
    const V a = law.distanceIn<kGraded>(met).a;
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

// --- a step ----------------------------------------------------------------------------------------------------------

/// How far particles may leave their places, over half the skin: between 0.65 and 1, different for each, or all that
/// move alike would have to be entered again in the same step. 1 is the most that keeps every contact listed; 0.65 is a
/// choice: the less, the more evenly entries spread over the ticks, and the more there are of them.
HWY_INLINE V relistThreshold(std::size_t particle) {
  const D d;
  const hn::RebindToSigned<D> di;
  const auto number = hn::Iota(di, static_cast<std::int32_t>(particle & 0xFFFF));
  const auto scattered = hn::And(number * hn::Set(di, 101), hn::Set(di, 255));
  return hn::MulAdd(hn::ConvertTo(d, scattered), set(0.35F / 255), set(0.65F));
}

/// What a particle of a class has of the constants of the step: half the radius is an eighth of the mass.
struct Grain {
  float skin_half_squared, inverse_mass;
  float weight_x, weight_y, weight_z;
  explicit Grain(const StepConstants& now, int grain_class = 0)
      : Grain(now, GrainClasses::scale(grain_class), GrainClasses::scale(3 * grain_class)) {}

 private:
  Grain(const StepConstants& now, float radius, float volume)  // over those of class 0: powers of two
      : skin_half_squared(now.skin_half_squared * radius * radius),
        inverse_mass(now.inverse_mass / volume),
        weight_x(now.weight_x * volume),
        weight_y(now.weight_y * volume),
        weight_z(now.weight_z * volume) {}
};

/// Moves particles on with their new velocity, and notes who is not at rest and who has gone far.
HWY_INLINE void moveOn(const StepConstants& now, const Grain& grain, const StepArrays& arrays, const Lanes& at,
                       const Records& here, const Records& velocity, Moved& moved, V& fastest_squared) {
  const D d;
  const V dt = set(now.dt);
  const Records next{hn::MulAdd(dt, velocity.x, here.x), hn::MulAdd(dt, velocity.y, here.y),
                     hn::MulAdd(dt, velocity.z, here.z), here.w};
  storeInOrder(velocity, arrays.next_velocity + at.particle());
  storeInOrder(next, arrays.next_position + at.particle());

  const V speed_squared =
      hn::MulAdd(velocity.x, velocity.x, hn::MulAdd(velocity.y, velocity.y, velocity.z * velocity.z));
  fastest_squared = hn::Max(fastest_squared, speed_squared);
  const bool moving = !hn::AllTrue(d, speed_squared <= set(now.rest_squared));
  std::uint8_t& any_moving = arrays.moving[at.group];
  any_moving = static_cast<std::uint8_t>(moving || (at.in_group > 0 && any_moving != 0));

  const Records place = loadInOrder(arrays.listed_at + at.particle());
  const V x = next.x - place.x;
  const V y = next.y - place.y;
  const V z = next.z - place.z;
  const V squared = hn::MulAdd(x, x, hn::MulAdd(y, y, z * z));
  const V share = relistThreshold(at.particle());
  const V limit = set(grain.skin_half_squared) * share * share;
  const auto stays = squared <= limit;  // false for NaN, too
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
HWY_INLINE Records unlessDriven(const Records& v, const Records& wanted) {
  const auto driven = v.w != hn::Zero(D());
  return {hn::IfThenElse(driven, v.x, wanted.x), hn::IfThenElse(driven, v.y, wanted.y),
          hn::IfThenElse(driven, v.z, wanted.z), v.w};
}

/// Neighbours, weight and others' forces together; the neighbours' share is kept if somebody wants to know it.
HWY_INLINE Triple<V> besidesWalls(const Sums& sums, const Grain& grain, const StepArrays& arrays, const Lanes& at) {
  if (arrays.contact_force != nullptr) {
    storeInOrder({sums.x, sums.y, sums.z, sums.repulsion}, arrays.contact_force + at.particle());
  }
  const Records push = loadInOrder(arrays.external + at.particle());
  return {sums.x + (set(grain.weight_x) + push.x), sums.y + (set(grain.weight_y) + push.y),
          sums.z + (set(grain.weight_z) + push.z)};
}

template <bool kPeriodic>
void paperIn(const KernelLaw& law, const StepConstants& now, const StepBox& box, const StepArrays& arrays,
             std::size_t first, std::size_t last, Moved& moved) {
  const PaperContacts contacts(law, box.periods, now.near_m);
  const D d;
  const V zero = hn::Zero(d);
  const V one = set(1);
  const V per_mass = set(now.dt * now.inverse_mass);
  const V half_width = set(box.half_width);
  const V half_length = set(box.half_length);
  const Grain grain(now);
  V fastest_squared = zero;
  forEachVector(arrays, now.look, first, last, [&](const Lanes& at) {
    const Records x = loadInOrder(arrays.position + at.particle());
    const Records v = loadInOrder(arrays.velocity + at.particle());
    Sums sums = contacts.sum<kPeriodic>(arrays, at, x);
    auto [fx, fy, fz] = besidesWalls(sums, grain, arrays, at);
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
    const V kept = Inverse(hn::MulAdd(per_mass * set(now.damping), sums.contacts, one));
    const V vx = hn::MulAdd(per_mass, fx, v.x) * kept;
    const V vy = hn::MulAdd(per_mass, fy, v.y) * kept;
    const V vz = hn::MulAdd(per_mass, fz, v.z) * kept;

    // Moving friction (paper 14, lower case) against the velocity; it stops the particle but never turns it round.
    const V huge = set(1e30F);  // what is infinite shall not be braked to a stop, but found out
    const V speed_squared = hn::Min(hn::MulAdd(vx, vx, hn::MulAdd(vy, vy, hn::MulAdd(vz, vz, set(1e-30F)))), huge);
    const V slowed_by = per_mass * set(now.moving_friction) * sums.repulsion;
    V left = hn::Max(hn::NegMulAdd(slowed_by, InverseSqrt(speed_squared), one), zero);

    // A particle at rest stays at rest up to the static limit (paper 14, upper case).
    const V limit = set(now.static_friction) * sums.repulsion;
    const auto at_rest = hn::And(hn::And(v.x == zero, v.y == zero), v.z == zero);
    const auto held = hn::MulAdd(fx, fx, hn::MulAdd(fy, fy, fz * fz)) <= limit * limit;
    left = hn::IfThenZeroElse(hn::And(at_rest, held), left);
    moveOn(now, grain, arrays, at, x, unlessDriven(v, {vx * left, vy * left, vz * left, zero}), moved, fastest_squared);
  });
  moved.fastest_squared = hn::GetLane(hn::MaxOfLanes(d, fastest_squared));
}

template <bool kGraded, bool kPeriodic>
void contactFrictionIn(const GradedLaw& law, const StepConstants& now, const StepBox& box, const StepArrays& arrays,
                       std::size_t first, std::size_t last, Moved& moved) {
  const PairLaws<kGraded> laws(law, now.dt, now.friction_ratio, now.near_m);
  auto mixed = laws.roomForMixed();
  const PeriodsOf periods(box.periods);
  const D d;
  const V zero = hn::Zero(d);
  const V one = set(1);
  const V drag = set(now.drag);
  const V ratio = set(box.wall_ratio);
  V fastest_squared = zero;
  forEachVector(arrays, now.look, first, last, [&](const Lanes& at) {
    const Records x = loadInOrder(arrays.position + at.particle());
    const Records v = loadInOrder(arrays.velocity + at.particle());
    const GroupLaws<kGraded> contacts = laws.of(arrays, at.group);
    const PairLaw& own = contacts.own();
    const Grain grain(now, kGraded ? arrays.grain_class[at.group] : 0);
    const V per_mass = set(now.dt * grain.inverse_mass);
    const Sums sums = frictionalSums<kGraded, kPeriodic, false>(contacts, periods, arrays, at, x, v, mixed.data());
    auto [fx, fy, fz] = besidesWalls(sums, grain, arrays, at);
    WallSlips& slips = arrays.wall_slip[at.group];
    std::uint8_t& near = arrays.near_walls[at.group];
    const auto of = [&](std::array<float, kGroup>& slip) { return slip.data() + at.in_group; };
    const auto floor = own.wall(one, {x.z - x.w, v.z, v.x, v.y, of(slips.floor_x), of(slips.floor_y), 1}, near);
    fx = fx + floor.along_1;
    fy = fy + floor.along_2;
    fz = fz + floor.away;
    if (box.walls_x) {
      const V inwards = hn::IfThenElse(x.x < zero, one, zero - one);  // from the nearer of the two walls
      const V distance = set(box.half_width) + inwards * x.x - x.w;
      const auto wall =
          own.wall(ratio, {distance, inwards * v.x, v.y, v.z, of(slips.x_wall_y), of(slips.x_wall_z), 2}, near);
      fx = hn::MulAdd(inwards, wall.away, fx);
      fy = fy + wall.along_1;
      fz = fz + wall.along_2;
    }
    if (box.walls_y) {
      const V inwards = hn::IfThenElse(x.y < zero, one, zero - one);
      const V distance = set(box.half_length) + inwards * x.y - x.w;
      const auto wall =
          own.wall(ratio, {distance, inwards * v.y, v.x, v.z, of(slips.y_wall_x), of(slips.y_wall_z), 4}, near);
      fx = fx + wall.along_1;
      fy = hn::MulAdd(inwards, wall.away, fy);
      fz = fz + wall.along_2;
    }
    const Records next{hn::MulAdd(per_mass, fx, v.x) * drag, hn::MulAdd(per_mass, fy, v.y) * drag,
                       hn::MulAdd(per_mass, fz, v.z) * drag, zero};
    moveOn(now, grain, arrays, at, x, unlessDriven(v, next), moved, fastest_squared);
  });
  moved.fastest_squared = hn::GetLane(hn::MaxOfLanes(d, fastest_squared));
}

void paper(const KernelLaw& law, const StepConstants& now, const StepBox& box, const StepArrays& arrays,
           std::size_t first, std::size_t last, Moved& moved) {
  (box.periods.any() ? paperIn<true> : paperIn<false>)(law, now, box, arrays, first, last, moved);
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

void paperSums(const KernelLaw& law, const Periods& periods, const StepArrays& arrays, std::size_t first,
               std::size_t last, ContactSum* sums) {
  const PaperContacts contacts(law, periods, 0);
  forEachVector(arrays, 0, first, last, [&](const Lanes& at) {
    const Records x = loadInOrder(arrays.position + at.particle());
    storeSums(contacts.sum<true>(arrays, at, x), sums + at.particle());
  });
}

template <bool kGraded>
void contactFrictionSumsOf(const GradedLaw& law, const Periods& box, float dt, const StepArrays& arrays,
                           std::size_t first, std::size_t last, ContactSum* sums) {
  const PairLaws<kGraded> laws(law, dt, 1, 0);
  auto mixed = laws.roomForMixed();
  const PeriodsOf periods(box);
  forEachVector(arrays, 0, first, last, [&](const Lanes& at) {
    const Records x = loadInOrder(arrays.position + at.particle());
    const Records v = loadInOrder(arrays.velocity + at.particle());
    storeSums(frictionalSums<kGraded, true, true>(laws.of(arrays, at.group), periods, arrays, at, x, v, mixed.data()),
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

HWY_EXPORT(paper);
HWY_EXPORT(contactFriction);
HWY_EXPORT(paperSums);
HWY_EXPORT(contactFrictionSums);

void stepWithPaperFriction(const KernelLaw& law, const StepConstants& now, const StepBox& box, const StepArrays& arrays,
                           std::size_t first, std::size_t last, Moved& moved) noexcept {
  HWY_DYNAMIC_DISPATCH(paper)(law, now, box, arrays, first, last, moved);
}

void stepWithContactFriction(const GradedLaw& law, const StepConstants& now, const StepBox& box,
                             const StepArrays& arrays, std::size_t first, std::size_t last, Moved& moved) noexcept {
  HWY_DYNAMIC_DISPATCH(contactFriction)(law, now, box, arrays, first, last, moved);
}

void sumContacts(const KernelLaw& law, const Periods& periods, const StepArrays& arrays, std::size_t first,
                 std::size_t last, ContactSum* sums) noexcept {
  HWY_DYNAMIC_DISPATCH(paperSums)(law, periods, arrays, first, last, sums);
}

void sumFrictionalContacts(const GradedLaw& law, const Periods& periods, float dt_s, const StepArrays& arrays,
                           std::size_t first, std::size_t last, ContactSum* sums) noexcept {
  HWY_DYNAMIC_DISPATCH(contactFrictionSums)(law, periods, dt_s, arrays, first, last, sums);
}

}  // namespace haptolith
#endif  // HWY_ONCE

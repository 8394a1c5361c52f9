// Rows of neighbours, one for each particle of a vector, and how far those are: what all laws of contact go through.
// Included again for every target, therefore the toggled guard (Highway's idiom).

#if defined(HAPTOLITH_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HAPTOLITH_ROWS_INL_H_
#undef HAPTOLITH_ROWS_INL_H_
#else
#define HAPTOLITH_ROWS_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "haptolith/bed/kernel/float4_vectors-inl.h"
#include "haptolith/bed/kernel/step_arrays.h"
#include "haptolith/soil/contact_law-inl.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

HWY_INLINE V set(float value) {
  return hn::Set(D(), value);
}

/// Position of a vector of particles in the arrays: 16 particles are a group, one vector of AVX-512 or several.
struct Lanes {
  std::size_t group, in_group, next_group;
  std::size_t rows;    // number of rows to compute
  InnerRows* pruning;  // inner list to fill in this pass; null: it is up to date
  [[nodiscard]] std::size_t particle() const { return group * kGroup + in_group; }
};

/// Rows of a group, and of the next one, which are prefetched a row at a time: lists are longer than processors look
/// ahead, and a large bed is in memory far slower than the kernel.
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
  [[nodiscard]] HWY_INLINE Float4Vectors positions(std::size_t row) const {
    return gatherFloat4(position_, other_ + row * kGroup);
  }
  [[nodiscard]] HWY_INLINE Float4Vectors velocities(std::size_t row) const {
    return gatherFloat4(velocity_, other_ + row * kGroup);
  }
  /// x of a row; y and z stand kGroup and 2 kGroup behind.
  [[nodiscard]] HWY_INLINE float* slips(std::size_t row) const { return slip_ + row * 3 * kGroup; }
  HWY_INLINE void prefetchNextNeighbours(std::size_t row) const { hwy::Prefetch(next_other_ + row * kGroup); }
  HWY_INLINE void prefetchNextSlips(std::size_t row) const {
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

// Quarters of a group that a vector covers; vectors of one particle share one.
constexpr std::size_t kQuarters = HWY_MAX(hn::MaxLanes(D()) / 4, 1);

/// Number of rows of a vector: the most of its quarters.
HWY_INLINE std::size_t rowsOf(const QuarterRows& rows, std::size_t in_group) {
  std::size_t most = 0;
  for (std::size_t quarter = in_group / 4; quarter < in_group / 4 + kQuarters; ++quarter) {
    most = HWY_MAX(most, std::size_t{rows[quarter]});
  }
  return most;
}

HWY_INLINE void setRows(QuarterRows& rows, std::size_t in_group, std::size_t count) {
  for (std::size_t quarter = in_group / 4; quarter < in_group / 4 + kQuarters; ++quarter) {
    rows[quarter] = static_cast<std::uint16_t>(count);
  }
}

/// In a large bed, whose particles are beyond a core's caches: prefetches the records of the neighbours of the next
/// group in groups[k..last-1], for one of its vectors, and a part of the list of the group after it.
HWY_INLINE void prefetchNeighbours(const StepArrays& arrays, std::size_t k, std::size_t last, std::size_t in_group) {
  constexpr std::size_t kApart = 4;  // neighbours of adjacent particles often share a cache line
  if (k + 2 >= last) {
    return;
  }
  const std::size_t next = arrays.groups[k + 1];
  const std::uint32_t* other = arrays.other + arrays.first_row[next] * kGroup + in_group;
  const std::size_t rows = rowsOf(arrays.touched[next], in_group);
  for (std::size_t row = 0; row < rows; ++row, other += kGroup) {
    for (std::size_t lane = 0; lane < hn::Lanes(D()); lane += kApart) {
      const std::size_t record = other[lane] / sizeof(Float4);
      hwy::Prefetch(arrays.position + record);
      hwy::Prefetch(arrays.velocity + record);
    }
  }
  const std::size_t after = arrays.groups[k + 2];
  if (in_group == 0) {
    for (std::size_t row = 0; row < arrays.touched[after].front(); ++row) {
      hwy::Prefetch(arrays.other + (arrays.first_row[after] + row) * kGroup);
    }
  }
}

/// Calls `each(lanes)` for all vectors of particles of groups[first..last-1], or of groups first..last-1. Groups whose
/// inner list is older than `pruning_pass` compute all rows and rebuild it.
template <class Each>
HWY_INLINE void forEachVector(const StepArrays& arrays, std::uint64_t pruning_pass, std::size_t first, std::size_t last,
                              const Each& each) {
  for (std::size_t k = first; k < last; ++k) {
    const std::size_t group = arrays.groups != nullptr ? arrays.groups[k] : k;
    const std::size_t next = arrays.groups != nullptr ? arrays.groups[k + 1] : k + 1;
    InnerRows* const inner = arrays.inner != nullptr ? arrays.inner + group : nullptr;
    const bool known = inner != nullptr && inner->pruning_pass == pruning_pass;
    Lanes at{group, 0, next, arrays.rows[group], known ? nullptr : inner};
    if (at.pruning != nullptr) {
      *inner = {pruning_pass, {}};
    }
    for (; at.in_group < kGroup; at.in_group += hn::Lanes(D())) {
      at.rows = known ? rowsOf(inner->rows, at.in_group) : at.rows;
      if (arrays.beyond_cache) {
        prefetchNeighbours(arrays, k, last, at.in_group);
      }
      each(at);
    }
  }
}

/// Extends the vector's inner list to `row`.
HWY_INLINE void keepInInnerList(const Lanes& at, std::size_t row) {
  setRows(at.pruning->rows, at.in_group, HWY_MAX(rowsOf(at.pruning->rows, at.in_group), row + 1));
}

/// A distance and its inverse from its square.
struct Distance {
  V metres, inverse;
};
HWY_INLINE Distance distanceOf(V squared) {
  const V metres = hn::Sqrt(squared);
  return {metres, Inverse(metres)};
}

struct PeriodsOf {
  V width, length, per_width, per_length;
  explicit PeriodsOf(const Periods& p)
      : width(set(p.width)), length(set(p.length)), per_width(set(p.per_width)), per_length(set(p.per_length)) {}
};

/// Vector from the neighbours to the particles, m, and its square, m^2.
struct Separation {
  V x, y, z, squared;
};
template <bool kPeriodic>
HWY_INLINE Separation separationOf(const PeriodsOf& periods, const Float4Vectors& here, const Float4Vectors& other) {
  const V x = nearestImage<kPeriodic>(here.x - other.x, periods.width, periods.per_width);
  const V y = nearestImage<kPeriodic>(here.y - other.y, periods.length, periods.per_length);
  const V z = here.z - other.z;
  const V tiny = set(1e-24F);  // two centres in one point repel nowhere, instead of 0/0
  return {x, y, z, MulAdd(x, x, MulAdd(y, y, MulAdd(z, z, tiny)))};
}

/// Forces of the neighbours, N; sum of repulsion, N; number of overlaps.
struct Sums {
  V x, y, z, repulsion, contacts;
};

HWY_INLINE LawOf<V> lawOf(const KernelLaw& law) {
  return {set(law.gamma), set(law.a_min), set(law.a_thr), set(law.h), set(law.k)};
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "haptolith/core/assert.h"

namespace haptolith {

/// Mean, percentiles and maximum of many values >= 0 in fixed memory. Mean and maximum are exact; a percentile is exact
/// to 1.1 %: it is the upper end of its bucket, never above the maximum. add() may be called in the tick.
class Histogram {
 public:
  /// @param smallest  values below it share the first bucket; values above smallest * 2^32 the last.
  explicit Histogram(double smallest) noexcept : smallest_(smallest) {}

  void add(double value) noexcept {
    ++count_;
    sum_ += value;
    max_ = std::max(max_, value);
    const double octaves = value > smallest_ ? std::log2(value / smallest_) : 0;
    const double bucket = std::min(octaves * kBucketsPerOctave, static_cast<double>(kBuckets - 1));
    ++buckets_[static_cast<std::size_t>(bucket)];
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] double mean() const noexcept { return count_ == 0 ? 0 : sum_ / static_cast<double>(count_); }
  [[nodiscard]] double max() const noexcept { return max_; }

  /// The value that a share of all values (0 to 1) does not exceed.
  [[nodiscard]] double percentile(double share) const noexcept {
    HAPTO_ASSERT(share >= 0 && share <= 1);
    const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
    std::uint64_t seen = 0;
    for (std::size_t bucket = 0; bucket < buckets_.size(); ++bucket) {
      seen += buckets_[bucket];
      if (seen >= wanted && seen > 0) {
        return std::min(max_, upperEnd(bucket));
      }
    }
    return max_;
  }

  /// For drawing: number of values in each bucket and the bucket's upper end.
  static constexpr std::size_t kBuckets = 32 * 64;
  [[nodiscard]] std::uint64_t inBucket(std::size_t bucket) const noexcept { return buckets_[bucket]; }
  [[nodiscard]] double upperEnd(std::size_t bucket) const noexcept {
    return smallest_ * std::exp2((static_cast<double>(bucket) + 1) / kBucketsPerOctave);
  }

 private:
  static constexpr double kBucketsPerOctave = 64;

  double smallest_;
  std::uint64_t count_ = 0;
  double sum_ = 0, max_ = 0;
  std::array<std::uint64_t, kBuckets> buckets_{};
};

}  // namespace haptolith

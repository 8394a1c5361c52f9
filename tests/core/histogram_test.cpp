#include "haptolith/core/histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace haptolith {
namespace {

/// A bucket is 1/64 octave wide: its upper end is at most 2^(1/64) = 1.0109 times what is in it.
const double kBucket = std::exp2(1.0 / 64);

TEST(Histogram, OfNothingIsZero) {
  const Histogram empty(0.1);
  EXPECT_EQ(empty.count(), 0U);
  EXPECT_EQ(empty.mean(), 0);
  EXPECT_EQ(empty.max(), 0);
  EXPECT_EQ(empty.percentile(0.5), 0);
}

TEST(Histogram, PercentilesAreThoseOfSortedDataToOneBucket) {
  std::mt19937_64 random(1);
  std::lognormal_distribution<double> times(3, 1.5);
  Histogram histogram(0.1);
  std::vector<double> values;
  double sum = 0;
  for (int i = 0; i < 10'000; ++i) {
    values.push_back(times(random));
    histogram.add(values.back());
    sum += values.back();
  }
  std::ranges::sort(values);
  for (const double share : {0.001, 0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * 10'000 - 1e-6));
    const double exact = values[rank - 1];
    // A rank that lands on a whole number may be rounded up by one: compare with that neighbour too.
    const double next = values[std::min(rank, values.size() - 1)];
    EXPECT_GE(histogram.percentile(share), exact * (1 - 1e-12)) << share;
    EXPECT_LE(histogram.percentile(share), next * kBucket * (1 + 1e-12)) << share;
  }
  EXPECT_EQ(histogram.max(), values.back());
  EXPECT_EQ(histogram.percentile(1), values.back());
  EXPECT_NEAR(histogram.mean(), sum / 10'000, 1e-9 * sum / 10'000);
}

TEST(Histogram, OneValueIsEveryPercentile) {
  Histogram histogram(1e-6);
  histogram.add(0.25);
  for (const double share : {0.0, 0.5, 1.0}) {
    EXPECT_EQ(histogram.percentile(share), 0.25);  // cut at the maximum, so exact
  }
}

TEST(Histogram, TakesValuesBelowAndAboveItsRange) {
  Histogram histogram(1);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double value : {0.0, 1e-9, 1e9, 1e300, infinity}) {
    histogram.add(value);
  }
  EXPECT_EQ(histogram.count(), 5U);
  EXPECT_LE(histogram.percentile(0.4), kBucket);
  EXPECT_EQ(histogram.inBucket(0), 2U);
  EXPECT_EQ(histogram.inBucket(Histogram::kBuckets - 1), 2U);
  EXPECT_EQ(histogram.max(), infinity);
}

TEST(Histogram, BucketsHoldWhatTheirEndsSay) {
  Histogram histogram(1);
  for (std::size_t bucket : {0, 1, 63, 64, 1000}) {
    histogram.add(histogram.upperEnd(bucket) / std::sqrt(kBucket));  // geometric centre
    EXPECT_EQ(histogram.inBucket(bucket), 1U) << bucket;
  }
}

}  // namespace
}  // namespace haptolith

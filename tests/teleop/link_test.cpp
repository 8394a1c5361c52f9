#include "haptolith/teleop/link/link.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kInterval_s = 0.01;

Packet numbered(int number) {
  return {static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8),
          static_cast<std::uint8_t>(number >> 16)};
}
int numberOf(const Packet& packet) {
  return packet[0] + 256 * packet[1] + 65536 * packet[2];
}

/// A packet that came through.
struct Came {
  int number;
  double took_s;
};

/// Sends a number of packets, one each `interval_s`; returns those received, in order of arrival.
std::vector<Came> through(Link& link, int packets, double interval_s = kInterval_s) {
  std::vector<Came> came;
  const auto take = [&](double until_s) {
    while (const std::optional<Link::Arrival> arrival = link.receive(until_s)) {
      const int number = numberOf(arrival->packet);
      came.push_back({number, arrival->time_s - number * interval_s});
    }
  };
  for (int i = 0; i < packets; ++i) {
    take(i * interval_s);
    link.send(i * interval_s, numbered(i));
  }
  take(std::numeric_limits<double>::infinity());
  return came;
}

std::vector<Came> through(const LinkParameters& parameters, int packets, double interval_s = kInterval_s) {
  Link link(parameters);
  return through(link, packets, interval_s);
}

double meanOf(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

TEST(Link, PassesEverythingOnAtOnceUnlessItIsTold) {
  const std::vector<Came> came = through(LinkParameters{}, 1000);
  ASSERT_EQ(came.size(), 1000U);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(came[static_cast<std::size_t>(i)].number, i);
    EXPECT_EQ(came[static_cast<std::size_t>(i)].took_s, 0);
  }
}

TEST(Link, APacketArrivesADelayLaterAndNotBefore) {
  Link link({.delay_s = 1.3});
  link.send(0.25, {7});
  EXPECT_DOUBLE_EQ(link.nextArrival().value(), 1.55);
  EXPECT_FALSE(link.receive(1.549));
  const auto arrival = link.receive(1.56);
  ASSERT_TRUE(arrival);
  EXPECT_DOUBLE_EQ(arrival->time_s, 1.55);
  EXPECT_EQ(arrival->packet, Packet{7});
  EXPECT_FALSE(link.receive(100));
  EXPECT_FALSE(link.nextArrival());
}

TEST(Link, TimeThatGoesBackStandsStill) {
  Link link({.delay_s = 1});
  link.send(5, {1});
  link.send(2, {2});
  EXPECT_DOUBLE_EQ(link.receive(10)->time_s, 6);
  EXPECT_DOUBLE_EQ(link.receive(10)->time_s, 6);
}

LinkParameters everything() {
  return {.delay_s = 0.4,
          .jitter_s = 0.05,
          .jitter_shape = JitterShape::kPareto,
          .jitter_correlation = 0.5,
          .in_order = false,
          .loss = 0.02,
          .turns_bad = 0.01,
          .turns_good = 0.2,
          .duplicate = 0.03,
          .rate_bit_s = 1e5,
          .outages = {{.start_s = 3, .duration_s = 0.5}}};
}

TEST(Link, RepeatsToTheBit) {
  const std::vector<Came> one = through(everything(), 3000);
  const std::vector<Came> again = through(everything(), 3000);
  ASSERT_EQ(one.size(), again.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one[i].number, again[i].number);
    ASSERT_EQ(one[i].took_s, again[i].took_s);
  }
  LinkParameters other = everything();
  other.seed = 2;
  EXPECT_NE(through(other, 3000).size(), one.size());
}

TEST(Link, WhatHappensDoesNotDependOnWhenSomebodyLooks) {
  Link link(everything());
  for (int i = 0; i < 3000; ++i) {
    link.send(i * kInterval_s, numbered(i));
  }
  const std::vector<Came> late = [&] {
    std::vector<Came> came;
    while (const auto arrival = link.receive(1e9)) {
      came.push_back({numberOf(arrival->packet), arrival->time_s});
    }
    return came;
  }();
  const std::vector<Came> at_once = through(everything(), 3000);
  ASSERT_EQ(late.size(), at_once.size());
  for (std::size_t i = 0; i < late.size(); ++i) {
    ASSERT_EQ(late[i].number, at_once[i].number);
  }
}

TEST(Link, CountsAddUp) {
  Link link(everything());
  const std::vector<Came> came = through(link, 5000);
  const LinkCounts& counts = link.counts();
  EXPECT_EQ(counts.sent, 5000U);
  EXPECT_EQ(counts.arrived, came.size());
  EXPECT_EQ(counts.arrived, counts.sent - counts.lost - counts.cut_off - counts.dropped + counts.duplicated);
  EXPECT_EQ(counts.onTheWay(), 0U);
  EXPECT_EQ(link.bytesOnTheWay(), 0U);
  link.send(1e3, Packet(500));
  EXPECT_EQ(counts.onTheWay() > 0, link.bytesOnTheWay() >= 500);
  for (const std::uint64_t some : {counts.lost, counts.cut_off, counts.duplicated, counts.overtaken}) {
    EXPECT_GT(some, 0U);
  }
}

// --- delay and jitter ------------------------------------------------------------------------------------------------

class Jitter : public testing::TestWithParam<std::pair<JitterShape, double>> {};

TEST_P(Jitter, HasItsMeanItsSpreadAndItsCorrelation) {
  const auto [shape, correlation] = GetParam();
  constexpr double kDelay_s = 1;
  constexpr double kJitter_s = 0.02;
  const std::vector<Came> came = through({.delay_s = kDelay_s,
                                          .jitter_s = kJitter_s,
                                          .jitter_shape = shape,
                                          .jitter_correlation = correlation,
                                          .in_order = false},
                                         200'000, 1000.0);  // so seldom that none overtakes another
  std::vector<double> beyond_s, squared, products;
  for (std::size_t i = 0; i < came.size(); ++i) {
    ASSERT_EQ(came[i].number, static_cast<int>(i));
    beyond_s.push_back(came[i].took_s - kDelay_s);
    squared.push_back(beyond_s[i] * beyond_s[i]);
    if (i > 0) {
      products.push_back(beyond_s[i] * beyond_s[i - 1]);
    }
  }
  const double variance = shape == JitterShape::kUniform ? kJitter_s * kJitter_s / 3 : kJitter_s * kJitter_s;
  // Standard errors with 200 000 packets, times sqrt((1 + rho) / (1 - rho)) of the mean; Pareto's of index 3 has no
  // fourth moment, and its variance converges slowly.
  const double correlated = std::sqrt((1 + correlation) / (1 - correlation));
  EXPECT_NEAR(meanOf(beyond_s), 0, 5 * std::sqrt(variance / 2e5) * correlated);
  EXPECT_NEAR(meanOf(squared) / variance, 1, shape == JitterShape::kPareto ? 0.35 : 0.02 * correlated);
  if (shape == JitterShape::kNormal) {
    EXPECT_NEAR(meanOf(products) / variance, correlation, 0.02 * correlated);
  } else {
    EXPECT_EQ(meanOf(products) / variance > 0.2, correlation > 0);
  }
  const double earliest_s = *std::ranges::min_element(beyond_s);
  if (shape == JitterShape::kUniform) {
    EXPECT_NEAR(earliest_s, -kJitter_s, 1e-4);
  } else if (shape == JitterShape::kPareto) {
    EXPECT_NEAR(earliest_s, -kJitter_s * 0.5 / std::sqrt(0.75), 1e-3) << "x >= 1, mean 1.5, deviation sqrt(3) / 2";
  }
}

INSTANTIATE_TEST_SUITE_P(All, Jitter,
                         testing::Values(std::pair{JitterShape::kNormal, 0.0}, std::pair{JitterShape::kNormal, 0.8},
                                         std::pair{JitterShape::kUniform, 0.0}, std::pair{JitterShape::kUniform, 0.8},
                                         std::pair{JitterShape::kPareto, 0.0}, std::pair{JitterShape::kPareto, 0.8}));

TEST(Link, NoPacketArrivesBeforeItIsSentHoweverLargeItsJitter) {
  for (const Came& packet : through({.delay_s = 0.01, .jitter_s = 1}, 2000)) {
    ASSERT_GE(packet.took_s, -1e-12);
  }
}

TEST(Link, OnOnePathNothingIsOvertaken) {
  LinkParameters parameters{.delay_s = 0.5, .jitter_s = 0.05};
  for (const bool in_order : {true, false}) {
    parameters.in_order = in_order;
    Link link(parameters);
    double before_s = 0;
    int number = -1;
    bool ordered = true;
    for (const Came& packet : through(link, 2000)) {
      ordered = ordered && packet.number > number;
      number = packet.number;
      const double at_s = packet.took_s + packet.number * kInterval_s;
      EXPECT_GE(at_s, before_s - 1e-12);
      before_s = at_s;
    }
    EXPECT_EQ(ordered, in_order);
    EXPECT_EQ(link.counts().overtaken == 0, in_order);
  }
}

TEST(Link, FollowsDelaysThatWereMeasured) {
  const std::vector<Came> came = through({.delay_s = 99, .delays = {{0.1, 0.5}, {0.3, 0.2}, {1, 0.7}}}, 150);
  const auto took_s = [&](double sent_s) {
    const auto number = static_cast<int>(std::lround(sent_s / kInterval_s));
    return std::ranges::find(came, number, &Came::number)->took_s;
  };
  EXPECT_NEAR(took_s(0), 0.5, 1e-9) << "the first holds before it, too";
  EXPECT_NEAR(took_s(0.29), 0.5, 1e-9);
  EXPECT_NEAR(took_s(0.45), 0.34, 1e-9) << "behind what was sent at 0.29 s and comes at 0.79";
  EXPECT_NEAR(took_s(0.9), 0.2, 1e-9);
  EXPECT_NEAR(took_s(1.4), 0.7, 1e-9);
}

// --- loss ------------------------------------------------------------------------------------------------------------

TEST(Link, LosesItsShare) {
  for (const double loss : {0.0, 0.01, 0.3, 1.0}) {
    const auto came = static_cast<double>(through({.loss = loss}, 100'000).size());
    EXPECT_NEAR(1 - came / 1e5, loss, 5 * std::sqrt(loss * (1 - loss) / 1e5)) << loss;
  }
}

TEST(Link, LosesInBurstsOfTheLengthOfGilbertAndElliott) {
  // 30 % in bursts of 25 packets: the hardest of the bench.
  const LinkParameters parameters{.turns_bad = 0.04 * 0.3 / 0.7, .turns_good = 0.04};
  EXPECT_NEAR(parameters.meanLoss(), 0.3, 1e-12);
  constexpr int kPackets = 400'000;
  int bursts = 0;
  int lost = 0;
  int next = 0;
  for (const Came& packet : through(parameters, kPackets)) {
    lost += packet.number - next;
    bursts += packet.number > next ? 1 : 0;
    next = packet.number + 1;
  }
  // About 5000 bursts, with an SD of the lengths equal to their mean.
  EXPECT_NEAR(static_cast<double>(lost) / kPackets, 0.3, 0.02);
  EXPECT_NEAR(static_cast<double>(lost) / bursts, 25, 5 * 25 / std::sqrt(bursts));
}

TEST(Link, LossesOfBothKindsAddAsMeanLossHasIt) {
  const LinkParameters parameters{.loss = 0.1, .turns_bad = 0.1, .turns_good = 0.3, .loss_while_bad = 0.5};
  EXPECT_NEAR(parameters.meanLoss(), 1 - 0.9 * (1 - 0.25 * 0.5), 1e-12);
  EXPECT_NEAR(1 - static_cast<double>(through(parameters, 200'000).size()) / 2e5, parameters.meanLoss(), 0.006);
}

TEST(Link, DeliversSomeTwice) {
  Link link({.delay_s = 0.1, .duplicate = 0.2});
  const std::vector<Came> came = through(link, 50'000);
  EXPECT_NEAR(static_cast<double>(came.size()) / 5e4, 1.2, 5 * std::sqrt(0.2 * 0.8 / 5e4));
  std::multiset<int> numbers;
  for (const Came& packet : came) {
    numbers.insert(packet.number);
  }
  for (int i = 0; i < 50'000; ++i) {
    ASSERT_LE(numbers.count(i), 2U);
    ASSERT_GE(numbers.count(i), 1U);
  }
}

TEST(Link, AnOutageLosesWhatIsSentInItAndNothingElse) {
  LinkParameters parameters{.delay_s = 2, .jitter_s = 0.01, .loss = 0.1};
  const std::vector<Came> whole = through(parameters, 3000);
  parameters.outages = {{.start_s = 5, .duration_s = 10}, {.start_s = 20, .duration_s = 1}};
  Link link(parameters);
  const std::vector<Came> cut = through(link, 3000);
  std::vector<Came> expected;
  std::ranges::copy_if(whole, std::back_inserter(expected), [](const Came& packet) {
    const double sent_s = packet.number * kInterval_s;
    return (sent_s < 5 || sent_s >= 15) && (sent_s < 20 || sent_s >= 21);
  });
  ASSERT_EQ(cut.size(), expected.size());
  for (std::size_t i = 0; i < cut.size(); ++i) {
    ASSERT_EQ(cut[i].number, expected[i].number);
  }
  EXPECT_EQ(link.counts().cut_off, 1100U);
}

// --- rate ------------------------------------------------------------------------------------------------------------

TEST(Link, SendsNoFasterThanItsRateAndQueuesTheRest) {
  // 3 bytes and 28 on top are 248 bit: 24.8 ms each at 10 kbit/s.
  Link link({.rate_bit_s = 1e4, .queue_packets = 20});
  const std::vector<Came> came = through(link, 1000);
  EXPECT_NEAR(came[0].took_s, 0.0248, 1e-12);
  EXPECT_NEAR(came[1].took_s, 2 * 0.0248 - kInterval_s, 1e-12) << "behind the first";
  double before_s = -1;
  double longest_s = 0;
  for (const Came& packet : came) {
    const double at_s = packet.took_s + packet.number * kInterval_s;
    ASSERT_GE(at_s - before_s, 0.0248 - 1e-9);
    before_s = at_s;
    longest_s = std::max(longest_s, packet.took_s);
  }
  EXPECT_NEAR(longest_s, 20 * 0.0248, 0.0248) << "a full queue";
  EXPECT_EQ(link.counts().dropped + came.size(), 1000U);
  EXPECT_NEAR(static_cast<double>(came.size()), 10 / 0.0248, 21);
}

TEST(Link, WithRoomEveryPacketTakesItsOwnTimeOnly) {
  for (const Came& packet : through({.delay_s = 0.1, .rate_bit_s = 1e5}, 500)) {
    ASSERT_NEAR(packet.took_s, 0.1 + 0.00248, 1e-9);
  }
}

// --- refused ---------------------------------------------------------------------------------------------------------

TEST(Link, RefusesWhatIsNoLink) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const LinkParameters& wrong : std::vector<LinkParameters>{
           {.delay_s = -1},
           {.delay_s = nan},
           {.delays = {{0, 1}, {0, 2}}},
           {.delays = {{-1, 1}}},
           {.jitter_s = -0.1},
           {.jitter_correlation = 1},
           {.loss = 1.1},
           {.turns_bad = 0.1, .turns_good = 0},
           {.duplicate = -1},
           {.rate_bit_s = -1},
           {.queue_packets = 0},
           {.outages = {{.start_s = 5, .duration_s = 10}, {.start_s = 10, .duration_s = 1}}},
       }) {
    EXPECT_THROW(Link{wrong}, InvalidParameter);
  }
}

}  // namespace
}  // namespace haptolith

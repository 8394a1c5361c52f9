#include "haptolith/bed/contact_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

namespace haptolith {
namespace {

/// Lists as a text book has them.
using Reference = std::vector<std::map<std::int32_t, Slip>>;

void expectSame(const ContactLists& lists, const Reference& reference) {
  std::size_t longest = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    ASSERT_EQ(lists.count(i), reference[i].size()) << i;
    std::map<std::int32_t, Slip> rest = reference[i];
    for (std::uint32_t s = 0; s < lists.count(i); ++s) {
      const auto found = rest.find(lists.neighbour(i, s));
      ASSERT_NE(found, rest.end()) << i << " lists " << lists.neighbour(i, s);
      const Slip slip = lists.slip(i, s);
      EXPECT_EQ(slip.x, found->second.x);
      EXPECT_EQ(slip.y, found->second.y);
      EXPECT_EQ(slip.z, found->second.z);
      EXPECT_EQ(lists.find(i, lists.neighbour(i, s)), s);
      rest.erase(found);
    }
    longest = i % kGroup == 0 ? reference[i].size() : std::max(longest, reference[i].size());
    if (i % kGroup == kGroup - 1 || i + 1 == reference.size()) {
      EXPECT_EQ(lists.rowCounts()[i / kGroup], longest) << "group " << i / kGroup;
      for (std::size_t lane = i / kGroup * kGroup; lane < i / kGroup * kGroup + kGroup; ++lane) {
        const std::size_t own = lane < reference.size() ? reference[lane].size() : 0;
        for (auto s = static_cast<std::uint32_t>(own); s < longest; ++s) {
          ASSERT_EQ(static_cast<std::size_t>(lists.neighbour(lane, s)), reference.size()) << "the ghost fills up";
          const Slip slip = lists.slip(lane, s);
          ASSERT_EQ(slip.x * slip.x + slip.y * slip.y + slip.z * slip.z, 0) << "and remembers nothing";
        }
      }
    }
  }
}

/// The rows behind touchedRows() remember nothing.
void expectNothingBehindTouched(ContactLists& lists) {
  for (std::size_t group = 0; group < lists.groups(); ++group) {
    const float* slips = lists.slips() + std::size_t{3} * kGroup * lists.firstRows()[group];
    for (std::size_t k = 0; k < 3 * kGroup; ++k) {
      for (std::size_t row = lists.touchedRows()[group][k % kGroup / 4]; row < lists.rowCounts()[group]; ++row) {
        ASSERT_EQ(slips[row * 3 * kGroup + k], 0) << "group " << group << " row " << row;
      }
    }
  }
}

class RandomContactLists : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Particles, RandomContactLists, testing::Values(1, 16, 17, 40));

TEST_P(RandomContactLists, AreWhatATextBookWouldHave) {
  const std::size_t particles = GetParam();
  std::mt19937 random(static_cast<unsigned>(particles));
  const auto below = [&random](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  ContactLists lists(particles, true);
  Reference reference(particles);
  for (int step = 0; step < 20'000; ++step) {
    const std::size_t i = below(particles);
    const auto j = static_cast<std::int32_t>(below(120));  // more than the smallest rooms hold
    // For a while lists grow, then they shrink.
    if (below(10) < (step / 2500 % 2 == 0 ? 7U : 3U)) {
      if (!reference[i].contains(j)) {
        ASSERT_TRUE(lists.add(i, j));
        reference[i][j] = {};
      }
      const Slip slip{static_cast<float>(below(100)), static_cast<float>(below(3)), -static_cast<float>(below(5))};
      lists.setSlip(i, lists.find(i, j), slip);
      reference[i][j] = slip;
    } else if (reference[i].contains(j)) {
      lists.removeNeighbour(i, j);
      reference[i].erase(j);
    }
    if (step % 500 == 0) {
      expectSame(lists, reference);
      expectNothingBehindTouched(lists);
    }
  }
  ContactLists copy(particles, true);
  ASSERT_TRUE(copy.add(0, 5));
  copy.takeOver(lists);
  expectSame(copy, reference);
  lists.clear();
  expectSame(lists, Reference(particles));
  expectNothingBehindTouched(lists);
}

TEST(ContactLists, ForgetWhichRowsAreNearWhenTheyChange) {
  ContactLists lists(20, true);
  const auto known = [&lists](std::size_t group) { return lists.innerRows()[group].pruning_pass != 0; };
  const auto know = [&lists] { lists.innerRows()[0].pruning_pass = lists.innerRows()[1].pruning_pass = 7; };
  know();
  ASSERT_TRUE(lists.add(17, 3));
  EXPECT_TRUE(known(0));
  EXPECT_FALSE(known(1));
  know();
  lists.set(17, 0, 4);
  EXPECT_FALSE(known(1));
  know();
  lists.setSlip(17, 0, {1, 2, 3});
  EXPECT_TRUE(known(1)) << "who is near does not depend on what is remembered";
  lists.remove(17, 0);
  EXPECT_FALSE(known(1));
  EXPECT_TRUE(known(0));
}

TEST(ContactLists, RefuseMoreThanFitsAndStayAsTheyWere) {
  ContactLists lists(1, false);
  std::uint32_t taken = 0;
  while (lists.add(0, static_cast<std::int32_t>(taken % 1000))) {
    ++taken;
    ASSERT_LE(taken, ContactLists::kMostNeighbours);
  }
  EXPECT_GE(taken, 96U) << "of one size";
  EXPECT_EQ(lists.count(0), taken);
  for (std::uint32_t s = 0; s < taken; ++s) {
    ASSERT_EQ(lists.neighbour(0, s), static_cast<std::int32_t>(s % 1000));
  }
}

TEST(ContactLists, AZeroWithASignCountsAsTouched) {
  ContactLists lists(16, true);
  ASSERT_TRUE(lists.add(2, 7));
  ASSERT_TRUE(lists.add(2, 8));
  lists.setSlip(2, 0, {});
  EXPECT_EQ(lists.touchedRows()[0][0], 0);
  lists.setSlip(2, 1, {0, -0.0F, 0});
  EXPECT_EQ(lists.touchedRows()[0][0], 2);
  EXPECT_EQ(lists.touchedRows()[0][1], 0) << "of another quarter of the group";
}

}  // namespace
}  // namespace haptolith

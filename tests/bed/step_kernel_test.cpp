#include "haptolith/bed/kernel/step_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "haptolith/core/vec.h"
#include "haptolith/soil/presets.h"
#include "haptolith/soil/printed_law.h"

#include "every_target.h"

namespace haptolith {
namespace {

struct Expected {
  Vec3 force_n = Vec3::Zero();
  double repulsion_n = 0;
  int contacts = 0;
};

/// A random crowd and its lists.
struct Crowd {
  SoilParameters soil;
  std::vector<Float4> position;  // in whole groups, once listed
  std::size_t n = 0;
  ContactLists lists;

  [[nodiscard]] std::size_t particles() const { return n; }
  [[nodiscard]] Vec3 at(std::size_t i) const { return {position[i].x, position[i].y, position[i].z}; }

  void list(double reach_m) {
    begin();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        if (i != j && (at(i) - at(j)).norm() < reach_m) {
          ASSERT_TRUE(lists.add(i, static_cast<std::int32_t>(j)));
        }
      }
    }
  }
  /// Without listed neighbours.
  void begin() {
    n = position.size();
    position.resize(paddedCount(n), kGhost);
    lists = ContactLists(n, false);
  }

  [[nodiscard]] std::vector<Expected> expected() const {
    std::vector<Expected> sums(particles());
    for (std::size_t i = 0; i < particles(); ++i) {
      for (std::size_t j = 0; j < particles(); ++j) {
        const double a = (at(i) - at(j)).norm();
        if (i == j || a == 0) {
          continue;
        }
        const double force = printedForce(soil, a);
        sums[i].force_n += force / a * (at(i) - at(j));
        sums[i].repulsion_n += std::max(force, 0.0);
        sums[i].contacts += a < 2 * soil.radius_m ? 1 : 0;
      }
    }
    return sums;
  }

  [[nodiscard]] std::vector<ContactSum> kernel(std::size_t first_group = 0, std::size_t last_group = ~std::size_t{0}) {
    std::vector<ContactSum> sums(position.size());
    sumContacts(kernelLaw(makeContactLaw(soil), soil.radius_m), {}, arrays(), first_group,
                std::min(last_group, lists.groups()), sums.data());
    sums.resize(n);
    return sums;
  }

  [[nodiscard]] StepArrays arrays() {
    StepArrays arrays{};
    arrays.position = position.data();
    arrays.other = lists.others();
    arrays.first_row = lists.firstRows();
    arrays.rows = lists.rowCounts();
    return arrays;
  }
};

/// `particles` at random in a cube of `edge_m`, so dense that every branch of the law is visited. Distances at which a
/// rounding error decides between contact and no contact, or between the cutoff's sides, are left out.
Crowd randomCrowd(const SoilParameters& soil, int particles, double edge_m, std::uint64_t seed) {
  Crowd crowd;
  crowd.soil = soil;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> anywhere(0, static_cast<float>(edge_m));
  const double jump = 2 * soil.radius_m * soil.attraction_ratio;
  while (static_cast<int>(crowd.position.size()) < particles) {
    const Float4 candidate{anywhere(random), anywhere(random), anywhere(random), 0};
    const Vec3 here(candidate.x, candidate.y, candidate.z);
    const bool clear = std::ranges::none_of(crowd.position, [&](const Float4& p) {
      const double a = (here - Vec3(p.x, p.y, p.z)).norm();
      // 1e-6 m: fifty times the rounding of a distance of 20 mm between float positions of 60 mm.
      return std::abs(a - jump) < 1e-6 || std::abs(a - 2 * soil.radius_m) < 1e-6;
    });
    if (clear) {
      crowd.position.push_back(candidate);
    }
  }
  crowd.list(jump + 0.5 * soil.radius_m);
  return crowd;
}

using ContactKernel = EveryTarget;

TEST_F(ContactKernel, IsTheEquationInDoublePrecisionForEveryPreset) {
  forEachTarget([] {
    for (const Preset& preset : presets()) {
      SCOPED_TRACE(preset.name);
      Crowd crowd = randomCrowd(preset.soil, 120, 0.06, 7);
      const std::vector<Expected> expected = crowd.expected();
      const std::vector<ContactSum> sums = crowd.kernel();
      double largest = 0;
      for (const Expected& e : expected) {
        largest = std::max(largest, e.repulsion_n);
      }
      ASSERT_GT(largest, 0);
      // Float has 6e-8; the hyperbola's denominator a - a_min loses a factor of about 14 mm / 0.5 mm on the way, and
      // about 20 neighbours are added up: 1e-5 of the largest sum of contact forces is what may be left.
      const double tolerance = 1e-5 * largest;
      for (std::size_t i = 0; i < sums.size(); ++i) {
        EXPECT_NEAR(sums[i].force_x_n, expected[i].force_n.x(), tolerance) << i;
        EXPECT_NEAR(sums[i].force_y_n, expected[i].force_n.y(), tolerance) << i;
        EXPECT_NEAR(sums[i].force_z_n, expected[i].force_n.z(), tolerance) << i;
        EXPECT_NEAR(sums[i].repulsion_n, expected[i].repulsion_n, tolerance) << i;
        EXPECT_EQ(sums[i].contacts, static_cast<float>(expected[i].contacts)) << i;
      }
    }
  });
}

TEST_F(ContactKernel, SumsExactlyTheGroupsItIsGiven) {
  forEachTarget([] {
    Crowd crowd = randomCrowd(presets()[3].soil, 50, 0.05, 11);
    const std::vector<ContactSum> all = crowd.kernel();
    const std::vector<ContactSum> some = crowd.kernel(1, 3);
    for (std::size_t i = 0; i < some.size(); ++i) {
      const bool summed = i >= kGroup && i < 3 * kGroup;
      EXPECT_EQ(some[i].contacts, summed ? all[i].contacts : 0) << i;
      EXPECT_EQ(some[i].force_x_n, summed ? all[i].force_x_n : 0) << i;
    }
  });
}

TEST_F(ContactKernel, GhostsContributeExactlyNothing) {
  forEachTarget([] {
    Crowd alone;
    alone.soil = presets()[3].soil;
    alone.position = {{0.01F, -0.02F, 0.03F, 0}};
    alone.begin();
    for (int i = 0; i < 20; ++i) {
      ASSERT_TRUE(alone.lists.add(0, 1));
    }
    const ContactSum sum = alone.kernel().front();
    EXPECT_EQ(sum.force_x_n, 0);
    EXPECT_EQ(sum.force_y_n, 0);
    EXPECT_EQ(sum.force_z_n, 0);
    EXPECT_EQ(sum.repulsion_n, 0);
    EXPECT_EQ(sum.contacts, 0);
  });
}

TEST_F(ContactKernel, APairWeighsTheSameInEveryPlaceOfItsGroup) {
  // Records are loaded whole and turned in registers: a swapped lane would give a neighbour another one's coordinate.
  forEachTarget([] {
    const double a = std::sqrt(64 + 36 + 25.0) * 1e-3;
    for (std::size_t one = 0; one < kGroup; ++one) {
      for (std::size_t two = 0; two < 2 * kGroup; ++two) {
        if (one == two) {
          continue;
        }
        Crowd pair;
        pair.soil = presets()[3].soil;
        for (std::size_t i = 0; i < 2 * kGroup; ++i) {
          pair.position.push_back({0.1F * static_cast<float>(i + 1), 0, 0, 0});
        }
        pair.position[one] = {0, 0, 0, 0};
        pair.position[two] = {0.008F, 0.006F, -0.005F, 0};
        pair.list(0.03);
        const double per_metre = printedForce(pair.soil, a) / a;
        const std::vector<ContactSum> sums = pair.kernel();
        EXPECT_NEAR(sums[one].force_x_n, per_metre * -0.008, 1e-6) << one << " " << two;
        EXPECT_NEAR(sums[one].force_y_n, per_metre * -0.006, 1e-6);
        EXPECT_NEAR(sums[one].force_z_n, per_metre * 0.005, 1e-6);
        EXPECT_EQ(sums[two].force_x_n, -sums[one].force_x_n);  // exact: equal operations with opposite signs
        EXPECT_EQ(sums[two].force_y_n, -sums[one].force_y_n);
        EXPECT_EQ(sums[two].force_z_n, -sums[one].force_z_n);
        for (std::size_t i = 0; i < sums.size(); ++i) {
          EXPECT_EQ(sums[i].contacts, i == one || i == two ? 1 : 0);
        }
      }
    }
  });
}

TEST_F(ContactKernel, TwoCentresInOnePointAreNoNaN) {
  forEachTarget([] {
    Crowd crowd;
    crowd.soil = presets()[3].soil;
    crowd.position = {{0.01F, 0.02F, 0.03F, 0}, {0.01F, 0.02F, 0.03F, 0}};
    crowd.list(0.01);
    for (const ContactSum& sum : crowd.kernel()) {
      EXPECT_EQ(sum.force_x_n, 0);
      EXPECT_EQ(sum.force_y_n, 0);
      EXPECT_EQ(sum.force_z_n, 0);
      EXPECT_TRUE(std::isfinite(sum.repulsion_n));
      EXPECT_GT(sum.repulsion_n, 0);
      EXPECT_EQ(sum.contacts, 1);
    }
  });
}

}  // namespace
}  // namespace haptolith

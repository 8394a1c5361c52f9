#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "haptolith/bed/kernel/step_kernel.h"
#include "haptolith/bed/measure/reference_contact.h"
#include "haptolith/core/vec.h"

#include "every_target.h"

namespace haptolith {
namespace {

constexpr float kStep_s = 2e-4F;

SoilParameters stiffSoil() {
  SoilParameters soil;
  soil.friction = FrictionModel::kContact;
  soil.stiffness_n_m = 1000;
  soil.contact_cohesion_n = 0.02;
  return soil;
}

Vec3 vec(const Float4& f) {
  return {f.x, f.y, f.z};
}

/// Particles, their lists and what their contacts remember.
struct Crowd {
  SoilParameters soil = stiffSoil();
  Periods periods;
  std::vector<Float4> position, velocity;  // in whole groups, once listed
  std::size_t n = 0;
  ContactLists lists;

  [[nodiscard]] std::size_t particles() const { return n; }

  [[nodiscard]] Vec3 between(std::size_t i, std::size_t j) const {
    Vec3 d = vec(position[i]) - vec(position[j]);
    d.x() -= periods.width * std::round(d.x() * periods.per_width);
    d.y() -= periods.length * std::round(d.y() * periods.per_length);
    return d;
  }

  void list(double reach_m) {
    n = position.size();
    lists = ContactLists(n, true);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        if (i != j && between(i, j).norm() < reach_m) {
          ASSERT_TRUE(lists.add(i, static_cast<std::int32_t>(j)));
        }
      }
    }
    position.resize(paddedCount(n), kGhost);
    velocity.resize(paddedCount(n), kGhostVelocity);
  }

  [[nodiscard]] std::size_t neighbour(std::size_t i, std::uint32_t s) const {
    return static_cast<std::size_t>(lists.neighbour(i, s));
  }
  [[nodiscard]] Vec3 slip(std::size_t i, std::uint32_t s) const {
    const Slip slip = lists.slip(i, s);
    return {slip.x, slip.y, slip.z};
  }

  [[nodiscard]] std::vector<ContactSum> kernel(std::size_t first_group = 0, std::size_t last_group = ~std::size_t{0}) {
    StepArrays arrays{};
    arrays.position = position.data();
    arrays.velocity = velocity.data();
    arrays.other = lists.others();
    arrays.slip = lists.slips();
    arrays.first_row = lists.firstRows();
    arrays.rows = lists.rowCounts();
    arrays.touched = lists.touchedRows();
    std::vector<ContactSum> sums(position.size());
    sumFrictionalContacts(gradedLaw(soil, 1), periods, kStep_s, arrays, first_group,
                          std::min(last_group, lists.groups()), sums.data());
    sums.resize(n);
    return sums;
  }
};

/// So dense that every branch is visited; with a memory that is as large as friction can make it, and of any direction.
/// Distances within a rounding of where a contact begins or ends are left out.
Crowd randomCrowd(const SoilParameters& soil, double edge_m, std::uint64_t seed, const Periods& periods = {}) {
  Crowd crowd;
  crowd.soil = soil;
  crowd.periods = periods;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  const ContactLaw law = makeContactLaw(soil);
  const auto excess = static_cast<float>(soil.size_spread * soil.radius_m);
  while (crowd.position.size() < 120) {
    crowd.position.push_back({static_cast<float>(edge_m) * unit(random), static_cast<float>(edge_m) * unit(random),
                              static_cast<float>(edge_m) * unit(random), excess * (2 * unit(random) - 1)});
    const std::size_t last = crowd.position.size() - 1;
    for (std::size_t i = 0; i < last; ++i) {
      const double a = crowd.between(i, last).norm() - crowd.position[i].w - crowd.position[last].w;
      if (std::abs(a - law.cutoff_m) < 1e-6 || std::abs(a - law.diameter_m) < 1e-6) {
        crowd.position.pop_back();
        break;
      }
    }
  }
  for (std::size_t i = 0; i < 120; ++i) {
    crowd.velocity.push_back({unit(random) - 0.5F, unit(random) - 0.5F, unit(random) - 0.5F, 0});
  }
  crowd.list(law.cutoff_m + 2 * excess + 0.5 * soil.radius_m);
  for (std::size_t i = 0; i < crowd.particles(); ++i) {  // one slip for a pair, from both sides
    for (std::uint32_t s = 0; s < crowd.lists.count(i); ++s) {
      const std::size_t j = crowd.neighbour(i, s);
      std::mt19937_64 of_pair(std::min(i, j) * 1000 + std::max(i, j));
      const float sign = i < j ? 1e-4F : -1e-4F;
      const auto anything = [&] { return sign * (2 * unit(of_pair) - 1); };
      const float x = anything();
      const float y = anything();
      crowd.lists.setSlip(i, s, {x, y, anything()});
    }
  }
  return crowd;
}

std::vector<SoilParameters> soils() {
  std::vector<SoilParameters> all(4, stiffSoil());
  all[1].contact_cohesion_n = 0;
  all[2].size_spread = 0.2;
  all[3].stiffness_n_m = 150;
  all[3].damping_ratio = 0;
  return all;
}

using ContactFrictionKernel = EveryTarget;

void expectTheReference(Crowd& crowd) {
  const Crowd before = crowd;
  const std::vector<ContactSum> sums = crowd.kernel();
  double largest = 0;
  std::vector<ReferencePair> expected(crowd.particles());
  for (std::size_t i = 0; i < crowd.particles(); ++i) {
    for (std::uint32_t s = 0; s < crowd.lists.count(i); ++s) {
      const std::size_t j = crowd.neighbour(i, s);
      const Vec3 apart = before.between(i, j);
      const double a = apart.norm() - crowd.position[i].w - crowd.position[j].w;
      Vec3 slip = before.slip(i, s);
      const ReferencePair pair = referenceContact(crowd.soil, apart.normalized(), a,
                                                  vec(crowd.velocity[i]) - vec(crowd.velocity[j]), kStep_s, slip);
      expected[i].force_n += pair.force_n;
      expected[i].compression_n += pair.compression_n;
      // A slip of 0.2 mm is known to some float roundings of the normal it is turned with: 1e-6 of it; where it is
      // limited, by how well the force is known, over k_t.
      EXPECT_LT((crowd.slip(i, s) - slip).norm(), 3e-9) << i << " " << j;
    }
    largest = std::max(largest, expected[i].compression_n);
  }
  ASSERT_GT(largest, 0);
  // As in the kernel of icra2021: 1e-5 of the largest sum of contact forces is what float may leave.
  const double tolerance = 1e-5 * largest;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    EXPECT_LT((Vec3(sums[i].force_x_n, sums[i].force_y_n, sums[i].force_z_n) - expected[i].force_n).norm(), tolerance);
    EXPECT_NEAR(sums[i].repulsion_n, expected[i].compression_n, tolerance) << i;
  }
}

TEST_F(ContactFrictionKernel, IsTheWordsOfItsDocumentationInDoublePrecision) {
  forEachTarget([] {
    for (const SoilParameters& soil : soils()) {
      Crowd crowd = randomCrowd(soil, 0.07, 7);
      expectTheReference(crowd);
    }
  });
}

TEST_F(ContactFrictionKernel, IsTheSameAcrossTheSeamOfAPeriodicBox) {
  forEachTarget([] {
    const Periods periods{0.08F, 0.09F, 1 / 0.08F, 1 / 0.09F};
    Crowd crowd = randomCrowd(stiffSoil(), 0.08, 9, periods);
    expectTheReference(crowd);
  });
}

TEST_F(ContactFrictionKernel, WhatAPairDoesToOneItUndoesToTheOtherToTheBit) {
  forEachTarget([] {
    for (const SoilParameters& soil : soils()) {
      Crowd crowd = randomCrowd(soil, 0.07, 11);
      (void)crowd.kernel();
      std::size_t remembered = 0;
      for (std::size_t i = 0; i < crowd.particles(); ++i) {
        for (std::uint32_t s = 0; s < crowd.lists.count(i); ++s) {
          const std::size_t j = crowd.neighbour(i, s);
          for (std::uint32_t t = 0; t < crowd.lists.count(j); ++t) {
            if (crowd.neighbour(j, t) == i) {
              ASSERT_EQ(crowd.slip(i, s), -crowd.slip(j, t)) << i << " " << j;
              remembered += crowd.slip(i, s).isZero(0) ? 0 : 1;
            }
          }
        }
      }
      EXPECT_GT(remembered, 100U);
    }
  });
}

TEST_F(ContactFrictionKernel, TheForcesOfACrowdAddUpToNothing) {
  forEachTarget([] {
    for (const SoilParameters& soil : soils()) {
      Crowd crowd = randomCrowd(soil, 0.07, 13);
      Vec3 sum = Vec3::Zero();
      double total = 0;
      for (const ContactSum& s : crowd.kernel()) {
        sum += Vec3(s.force_x_n, s.force_y_n, s.force_z_n);
        total += Vec3(s.force_x_n, s.force_y_n, s.force_z_n).norm();
      }
      // Each force is exact in its opposite; only sums over a particle's neighbours are rounded, 6e-8 each time.
      EXPECT_LT(sum.norm(), 1e-6 * total);
    }
  });
}

TEST_F(ContactFrictionKernel, SumsExactlyTheGroupsItIsGiven) {
  forEachTarget([] {
    Crowd crowd = randomCrowd(stiffSoil(), 0.07, 15);
    Crowd whole = crowd;
    const std::vector<ContactSum> all = whole.kernel();
    const std::vector<ContactSum> some = crowd.kernel(2, 4);
    for (std::size_t i = 0; i < some.size(); ++i) {
      EXPECT_EQ(some[i].force_x_n, i >= 2 * kGroup && i < 4 * kGroup ? all[i].force_x_n : 0) << i;
    }
  });
}

TEST_F(ContactFrictionKernel, TwoCentresInOnePointAreNoNaNAndCanGoOn) {
  forEachTarget([] {
    Crowd crowd;
    crowd.position = {{0.01F, 0.02F, 0.03F, 0}, {0.01F, 0.02F, 0.03F, 0}};
    crowd.velocity = {{0.1F, 0, -0.2F, 0}, {}};
    crowd.list(0.01);
    for (int i = 0; i < 3; ++i) {
      for (const ContactSum& sum : crowd.kernel()) {
        EXPECT_TRUE(std::isfinite(sum.force_x_n) && std::isfinite(sum.force_y_n) && std::isfinite(sum.force_z_n));
        EXPECT_TRUE(std::isfinite(sum.repulsion_n));
      }
      EXPECT_TRUE(crowd.slip(0, 0).allFinite());
    }
  });
}

}  // namespace
}  // namespace haptolith

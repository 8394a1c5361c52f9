#include "haptolith/bed/kernel/stone_kernel.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "haptolith/bed/stone_contact.h"
#include "haptolith/core/math/random.h"
#include "haptolith/soil/soil_parameters.h"
#include "haptolith/stone/stone_shape.h"

#include "every_target.h"

namespace haptolith {
namespace {

/// A rock that moves and turns, and sixteen grains at random places about its surface.
class StoneKernel : public EveryTarget {
 protected:
  StoneKernel() {
    soil_.friction = FrictionModel::kContact;
    soil_.contact_cohesion_n = 0.02;
    soil_.stiffness_n_m = 1000;
    law_ = StoneContactLaw::withGrains(soil_, {rock_.radius(), soil_.radius_m, 0.1, macroparticleMass(soil_)});
    for (const StoneSphere& sphere : rock_.spheres) {
      const Eigen::Vector3f centre = sphere.centre_m.cast<float>();
      spheres_.push_back({centre.x(), centre.y(), centre.z(), static_cast<float>(sphere.radius_m)});
    }
    numbers_.resize(spheres_.size());
    std::iota(numbers_.begin(), numbers_.end(), std::uint16_t{0});
    position_.resize(kGroup);
    velocity_.resize(kGroup);
    pack_.count = kGroup;
    for (std::size_t k = 0; k < kGroup; ++k) {
      const auto any = [&] { return uniformSigned(random_); };
      // Down onto the rock from outside until it is a little inside, or just misses.
      const Vec3 way = Vec3(any(), any(), any()).normalized();
      const double excess_m = 0.1 * soil_.radius_m * any();
      double far_m = rock_.reach_m + 3 * soil_.radius_m;
      const double wanted_m = k % 4 == 3 ? -4e-3 : 3e-4 * (any() + 0.7);
      while (overlap(middle_m_ + far_m * way, soil_.radius_m + excess_m).depth_m < wanted_m) {
        far_m -= 1e-5;
      }
      const Vec3 place = middle_m_ + far_m * way;
      position_[k] = {static_cast<float>(place.x()), static_cast<float>(place.y()), static_cast<float>(place.z()),
                      static_cast<float>(excess_m)};
      velocity_[k] = {static_cast<float>(0.1 * any()), static_cast<float>(0.1 * any()), static_cast<float>(0.1 * any()),
                      0};
      pack_.particle[k] = static_cast<std::int32_t>(k);
      for (auto& of_axis : pack_.stretch_m) {
        of_axis[k] = static_cast<float>(2e-5 * any());
      }
    }
  }

  [[nodiscard]] Vec3 centre(const StoneSphere& sphere) const { return middle_m_ + rotation_ * sphere.centre_m; }

  [[nodiscard]] Overlap overlap(const Vec3& place_m, double radius_m) const {
    OverlapOfSpheres with;
    for (const StoneSphere& sphere : rock_.spheres) {
      with.add(place_m - centre(sphere), sphere.radius_m + radius_m);
    }
    return with.overlap();
  }

  void press(std::span<const std::uint16_t> numbers) {
    const ContactFrictionLaw law = law_.inKernel();
    const StoneMotion motion(middle_m_, rotation_, moves_m_s_, rotation_.transpose() * turns_rad_s_);
    pressPack({.law = law,
               .motion = motion,
               .spheres = spheres_.data(),
               .numbers = numbers,
               .grain_m = static_cast<float>(soil_.radius_m),
               .dt_s = static_cast<float>(kStep_s)},
              position_.data(), velocity_.data(), pack_, touch_);
  }

  /// Force on each particle separately, in double precision.
  void expectTheLawAfter(const StonePack& before) const {
    int touching = 0;
    for (std::size_t k = 0; k < kGroup; ++k) {
      const Vec3 place(position_[k].x, position_[k].y, position_[k].z);
      const double own_m = soil_.radius_m + position_[k].w;
      const Overlap with = overlap(place, own_m);
      EXPECT_NEAR(touch_.beyond_m[k], -with.depth_m - law_.reach(), 1e-7) << k;
      if (-with.depth_m >= law_.reach()) {
        EXPECT_EQ(pack_.stretch_m[0][k], 0) << k;
        continue;
      }
      ++touching;
      const Vec3 lever = place - (own_m - with.depth_m / 2) * with.towards - middle_m_;
      const Vec3 relative =
          Vec3(velocity_[k].x, velocity_[k].y, velocity_[k].z) - moves_m_s_ - turns_rad_s_.cross(lever);
      Vec3 stretch = rotation_ * Vec3(before.stretch_m[0][k], before.stretch_m[1][k], before.stretch_m[2][k]);
      const Vec3 force = law_.force(with, relative, kStep_s, stretch);
      const Vec3 found(touch_.force_n[0][k], touch_.force_n[1][k], touch_.force_n[2][k]);
      EXPECT_LT((found - force).norm(), 1e-3 * force.norm() + 1e-5) << k;
      EXPECT_LT((Vec3(touch_.lever_m[0][k], touch_.lever_m[1][k], touch_.lever_m[2][k]) - lever).norm(), 2e-7) << k;
      const Vec3 kept = rotation_ * Vec3(pack_.stretch_m[0][k], pack_.stretch_m[1][k], pack_.stretch_m[2][k]);
      EXPECT_LT((kept - stretch).norm(), 1e-3 * stretch.norm() + 1e-9) << k;
    }
    EXPECT_GE(touching, 8);
  }

  static constexpr double kStep_s = 2e-4;
  std::mt19937_64 random_{7};
  SoilParameters soil_;
  StoneShape rock_ = angularRock(0.04, 3);
  StoneContactLaw law_;
  Vec3 middle_m_{0.21, -0.13, 0.047};
  Eigen::Matrix3d rotation_ =
      (Eigen::AngleAxisd(0.7, Vec3::UnitX()) * Eigen::AngleAxisd(-1.9, Vec3::UnitY())).toRotationMatrix();
  Vec3 moves_m_s_{0.03, -0.02, 0.05}, turns_rad_s_{2, -1, 3};
  std::vector<Float4> spheres_, position_, velocity_;
  std::vector<std::uint16_t> numbers_;
  StonePack pack_;
  PackTouch touch_{};
};

TEST_F(StoneKernel, IsTheLawOfOneGrainAfterTheOther) {
  const StonePack before = pack_;
  forEachTarget([&] {
    pack_ = before;
    press(numbers_);
    expectTheLawAfter(before);
  });
}

TEST_F(StoneKernel, SpheresThatAreNotNearChangeNothing) {
  std::vector<std::uint16_t> near;
  for (const std::uint16_t number : numbers_) {
    const StoneSphere& sphere = rock_.spheres[number];
    for (std::size_t k = 0; k < kGroup; ++k) {
      const Vec3 place(position_[k].x, position_[k].y, position_[k].z);
      const double gap_m = (place - centre(sphere)).norm() - sphere.radius_m - soil_.radius_m - position_[k].w;
      if (gap_m < 5e-3) {
        near.push_back(number);
        break;
      }
    }
  }
  ASSERT_LT(near.size(), numbers_.size());
  const StonePack before = pack_;
  press(numbers_);
  const PackTouch of_all = touch_;
  const StonePack pack_of_all = pack_;
  pack_ = before;
  press(near);
  EXPECT_EQ(touch_.force_n, of_all.force_n);
  EXPECT_EQ(touch_.lever_m, of_all.lever_m);
  EXPECT_EQ(pack_.stretch_m, pack_of_all.stretch_m);
}

}  // namespace
}  // namespace haptolith

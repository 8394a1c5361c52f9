#include "haptolith/lab/apparatus/contact_network.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "haptolith/bed/critical_step.h"
#include "haptolith/core/math/random.h"
#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/scene/scene.h"
#include "haptolith/tool/tool_shape.h"

#include "lab_soils.h"

namespace haptolith {
namespace {

/// Springs of 1 N/m along and `across` N/m across their contacts, without damping.
ContactLink spring(std::int32_t first, std::int32_t second, const Vec3& normal, double across = 0) {
  return {.first = first,
          .second = second,
          .normal = normal.normalized(),
          .stiffness_n_m = {1, across},
          .damping_n_s_m = {0, 0}};
}

TEST(ContactNetwork, TwoThatTouchSwingAtTwiceTheirStiffness) {
  ContactNetwork pair{.particles = 2, .mass_kg = 0.5, .links = {spring(0, 1, Vec3(1, 2, 3), 0.25)}};
  EXPECT_NEAR(largestFrequencySquared(pair), 2 * 1 / 0.5, 1e-9);
  pair.links = {spring(0, 1, Vec3(1, 2, 3), 3)};  // stiffer across than along
  EXPECT_NEAR(largestFrequencySquared(pair), 2 * 3 / 0.5, 1e-9);
  pair.links = {spring(0, ContactLink::kFixed, Vec3::UnitY())};
  EXPECT_NEAR(largestFrequencySquared(pair), 1 / 0.5, 1e-9);
}

TEST(ContactNetwork, AChainSwingsAsTheTextbooksSay) {
  // n equal masses, ends free: the fastest mode has m omega^2 = 4 k sin^2(pi (n - 1) / (2 n)).
  for (const int n : {3, 10, 50}) {
    ContactNetwork chain{.particles = static_cast<std::size_t>(n), .mass_kg = 1, .links = {}};
    for (int i = 0; i + 1 < n; ++i) {
      chain.links.push_back(spring(i, i + 1, Vec3(1, 1, 0)));
    }
    const double expected = 4 * std::pow(std::sin(std::numbers::pi * (n - 1) / (2.0 * n)), 2);
    EXPECT_NEAR(largestFrequencySquared(chain), expected, 1e-6 * expected) << n;
  }
}

/// A face-centred cubic crystal that repeats itself after `cells` cubes.
ContactNetwork fcc(int cells, double across) {
  ContactNetwork crystal{.particles = 0, .mass_kg = 1, .links = {}};
  const int n = 2 * cells;  // sites with an even sum of coordinates
  std::vector<std::int32_t> number(static_cast<std::size_t>(n * n * n), -1);
  const auto at = [&](int x, int y, int z) -> std::int32_t& {
    const auto wrapped = [n](int i) { return (i + n) % n; };
    return number[static_cast<std::size_t>((wrapped(x) * n + wrapped(y)) * n + wrapped(z))];
  };
  const auto each = [n](const auto& site) {
    for (int x = 0; x < n; ++x) {
      for (int y = 0; y < n; ++y) {
        for (int z = 0; z < n; ++z) {
          if ((x + y + z) % 2 == 0) {
            site(x, y, z);
          }
        }
      }
    }
  };
  each([&](int x, int y, int z) { at(x, y, z) = static_cast<std::int32_t>(crystal.particles++); });
  each([&](int x, int y, int z) {
    for (const int sign : {-1, 1}) {
      crystal.links.push_back(spring(at(x, y, z), at(x + 1, y + sign, z), Vec3(1, sign, 0), across));
      crystal.links.push_back(spring(at(x, y, z), at(x + 1, y, z + sign), Vec3(1, 0, sign), across));
      crystal.links.push_back(spring(at(x, y, z), at(x, y + 1, z + sign), Vec3(0, 1, sign), across));
    }
  });
  return crystal;
}

TEST(ContactNetwork, ACloseCrystalSwingsAtEightAndWithTangentsOfHalfAtTwelve) {
  // Planes along a cube's edge against each other (point X of the zone): 8 of the 12 contacts of a particle are between
  // planes, and what goes along the edge stretches each by half its square: 2 * 8 * (1/2 + 1/2 r), r = k_t / k.
  for (const double ratio : {0.0, 0.5, 1.0}) {
    EXPECT_NEAR(largestFrequencySquared(fcc(3, ratio)), 8 + 8 * ratio, 1e-4) << ratio;
  }
}

/// As above by assembling the complete matrix, in Eigen's order.
Eigen::MatrixXd dense(const ContactNetwork& network, double dt_s) {
  const auto n = static_cast<Eigen::Index>(3 * network.particles);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (const ContactLink& link : network.links) {
    const Eigen::Matrix3d along = link.normal * link.normal.transpose();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - along;
    const Eigen::Matrix3d block =
        (dt_s > 0 ? dt_s * dt_s * link.stiffness_n_m.along + 2 * dt_s * link.damping_n_s_m.along
                  : link.stiffness_n_m.along) *
            along +
        (dt_s > 0 ? dt_s * dt_s * link.stiffness_n_m.across + 2 * dt_s * link.damping_n_s_m.across
                  : link.stiffness_n_m.across) *
            across;
    matrix.block<3, 3>(3 * link.first, 3 * link.first) += block;
    if (link.second >= 0) {
      matrix.block<3, 3>(3 * link.second, 3 * link.second) += block;
      matrix.block<3, 3>(3 * link.first, 3 * link.second) -= block;
      matrix.block<3, 3>(3 * link.second, 3 * link.first) -= block;
    }
  }
  return matrix / network.mass_kg;
}

/// Soil in a box of the paper's size on the floor, compressed by a strong gravity.
Bed lying(const SoilParameters& soil, int particles) {
  BedParameters bed;
  bed.soil = soil;
  bed.gravity_m_s2 = {0, 0, -9.81};
  bed.start = BedStart::kRain;
  bed.particles = particles;
  bed.width_m = bed.length_m = 0.07;
  return Bed(bed);
}

TEST(ContactNetwork, OfRealBedsIsWhatADenseSolverFinds) {
  for (const double cohesion_n : {0.0, 0.4}) {
    const Bed bed = lying(testSoil(0.5, cohesion_n), 200);
    ContactNetwork network = contactNetwork(bed);
    const ToolParameters tool;
    addTool(network, tool, {{0, 0, bed.surfaceHeight() - 0.01}, Quat::Identity()}, 2e-4, bed);
    ASSERT_GT(network.links.size(), 600U);
    const auto largest = [](const Eigen::MatrixXd& matrix) {
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
    };
    const double expected = largest(dense(network, 0));
    EXPECT_NEAR(largestFrequencySquared(network), expected, 1e-5 * expected);
    const double share = largest(dense(network, 2e-4)) / 4;
    EXPECT_NEAR(shareOfStableStep(network, 2e-4), share, 1e-5 * share);
  }
}

/// Largest eigenvalue's magnitude of the step itself, positions and velocities together.
double growth(const ContactNetwork& network, double dt_s) {
  ContactNetwork springs = network, dampers = network;
  for (ContactLink& link : dampers.links) {
    link.stiffness_n_m = link.damping_n_s_m;
  }
  const Eigen::MatrixXd k = dense(springs, 0);
  const Eigen::MatrixXd c = dense(dampers, 0);
  const Eigen::Index n = k.rows();
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd step(2 * n, 2 * n);
  step << one - dt_s * dt_s * k, dt_s * (one - dt_s * c), -dt_s * k, one - dt_s * c;
  return Eigen::EigenSolver<Eigen::MatrixXd>(step, false).eigenvalues().cwiseAbs().maxCoeff();
}

TEST(ContactNetwork, TheStepIsStableUpToItsShareOfOneAndNotBeyond) {
  // Walls, cohesion and friction, whose dampers and springs have different modes: nothing that could be worked out mode
  // by mode.
  const ContactNetwork network = contactNetwork(lying(testSoil(0.5, 0.2), 60));
  double shortest = 1e-4, longest = 1e-3;
  for (int i = 0; i < 40; ++i) {
    const double middle = (shortest + longest) / 2;
    (shareOfStableStep(network, middle) < 1 ? shortest : longest) = middle;
  }
  EXPECT_LE(growth(network, 0.5 * shortest), 1 + 1e-9);
  EXPECT_LE(growth(network, 0.999 * shortest), 1 + 1e-9);
  EXPECT_GT(growth(network, 1.001 * shortest), 1.0005);
}

/// Soil with about 20 kPa on its lowest layer.
ContactNetwork pressed(const SoilParameters& soil) {
  BedParameters parameters;
  parameters.soil = soil;
  parameters.start = BedStart::kRain;
  parameters.particles = 250;
  parameters.width_m = parameters.length_m = 0.084;
  Bed bed(parameters);
  bed.setGravity({0, 0, -250});
  const double dt_s = 0.5 / stepsPerSecond(soil, 0);
  for (double time_s = 0; time_s < 0.5; time_s += dt_s) {
    EXPECT_EQ(bed.step(dt_s), StepStatus::kOk);
  }
  return contactNetwork(bed);
}

TEST(ContactNetwork, TheStepOfTheLawIsStableInAPressedBedAndNotMuchShorterThanItMustBe) {
  for (const double cohesion_n : {0.0, 0.25, 0.9}) {
    for (const double damping : {0.0, 0.2, 0.5}) {
      SoilParameters soil = testSoil(0.3, cohesion_n);
      soil.damping_ratio = damping;
      const ContactNetwork network = pressed(soil);
      const double share = shareOfStableStep(network, 1 / stepsPerSecond(soil, 0));
      EXPECT_LT(share, 1) << cohesion_n << " N, " << damping;
      EXPECT_GT(share, damping == 0 ? 0.12 : 0.8)
          << cohesion_n << " N, " << damping;  // undamped: accuracy asks for more
    }
  }
}

TEST(ContactNetwork, TheStepOfTheLawIsStableWhereGrainsOfSeveralSizesAreMixedAndPressed) {
  // Under about 20 kPa, as above. A fine grain between coarse ones has springs a third stiffer than among
  // its like, but fewer fit around it and none of them gives way as fast.
  for (const int classes : {2, 3}) {
    LabConditions conditions;
    conditions.soil = testSoil(0.3, 0.25);
    const LabBox box{.width_m = 0.06, .length_m = 0.06};
    const std::vector<Vec3> places = looseSoil(conditions.soil, box, classes == 2 ? 60 : 36, 0, 1);
    LabBed lab(conditions, box, mixedGrains(conditions.soil, places, classes, 1), classes, {});
    lab.settle(Preparation::kDense);
    lab.bed().setGravity({0, 0, -600});
    lab.run(0.3, "pressing");
    const ContactNetwork network = contactNetwork(lab.bed());
    const double share = shareOfStableStep(network, 1 / stepsPerSecond(finestSoil(lab.bed().parameters()), 0));
    EXPECT_LT(share, 1) << classes;
    EXPECT_GT(share, 0.6) << classes;
  }
}

TEST(ContactNetwork, TheStepOfTheLawIsStableBetweenTwoTools) {
  // Soil that floats, pressed between two plates until the whole layer is a third thinner.
  for (const double stiffness_n_m : {500.0, 2000.0}) {
    BedParameters bed;
    bed.soil = testSoil(0.3, 0);
    bed.gravity_m_s2 = Vec3::Zero();
    const double radius_m = bed.soil.radius_m;
    std::vector<Vec3> centres_m;
    for (int i = 0; i < 5 * 5 * 3; ++i) {
      centres_m.push_back(Vec3(0, 0, 0.1) + 2 * radius_m * Vec3(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 1));
    }
    ToolParameters plate;
    plate.size_m = {0.2, 0.2, 0.005};
    plate.stiffness_n_m = stiffness_n_m;
    Scene scene(bed, ToolSet({plate, plate}), centres_m);
    const auto hands = [&](int tick) {
      const double apart_m = 3 * radius_m + 0.0025 - radius_m * tick / 400;
      const double m_s = radius_m / 0.4;
      std::array<HandState, 2> both;
      for (std::size_t i = 0; i < 2; ++i) {
        const double side = i == 0 ? -1 : 1;
        both[i].pose.position_m = {0, 0, 0.1 + side * apart_m};
        both[i].twist.linear_m_s = {0, 0, -side * m_s};
      }
      return both;
    };
    scene.placeTool(hands(0)[0], 0);
    scene.placeTool(hands(0)[1], 1);
    double largest = 0;
    const double dt_s = bed.tick_s / scene.substeps();
    for (int tick = 1; tick <= 400; ++tick) {
      const auto now = hands(tick);
      ASSERT_EQ(scene.tickAll(now), StepStatus::kOk);
      if (tick % 40 == 0) {
        ContactNetwork network = contactNetwork(scene.bed());
        addTool(network, plate, now[0].pose, dt_s, scene.bed());
        addTool(network, plate, now[1].pose, dt_s, scene.bed());
        largest = std::max(largest, shareOfStableStep(network, dt_s));
      }
    }
    EXPECT_LT(largest, 1) << stiffness_n_m;
    EXPECT_GT(largest, 0.3) << stiffness_n_m;
  }
}

}  // namespace
}  // namespace haptolith

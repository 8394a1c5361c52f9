#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/soil/presets.h"

#include "every_target.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

/// Number of particles that gives three threads work (a thread is used for every 4096).
BedParameters largeBed(int threads) {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  bed.width_m = bed.length_m = 0.75;
  bed.start = BedStart::kPacked;
  bed.depth_m = 0.06;
  bed.threads = threads;
  return bed;
}

/// Gravity tips over and the bed sloshes: everything moves, contacts are made and broken, lists are rebuilt.
Bed tippedBed(int threads) {
  BedParameters parameters = largeBed(threads);
  const Bed level(parameters);
  std::vector<Vec3> centres;
  for (std::size_t i = 0; i < level.particles(); ++i) {
    const Float4& p = level.state().position[i];
    centres.emplace_back(p.x, p.y, p.z);
  }
  parameters.gravity_m_s2 = {8, 3, -2};
  return Bed(parameters, centres);
}

void run(Bed& bed, int steps) {
  for (int i = 0; i < steps; ++i) {
    ASSERT_EQ(bed.step(kTick_s), StepStatus::kOk);
  }
}

TEST(Determinism, SameHashForAnyNumberOfThreadsAndForEveryRun) {
  std::vector<std::uint64_t> expected;
  for (const int threads : {1, 2, 3, 1, 3}) {
    Bed bed = tippedBed(threads);
    ASSERT_GT(bed.particles(), 3U * 4096);
    std::vector<std::uint64_t> hashes;
    for (int hundred = 0; hundred < 4; ++hundred) {
      run(bed, 100);
      hashes.push_back(stateHash(bed.state()));
    }
    EXPECT_GT(bed.listRebuilds(), 5 * bed.particles()) << "too quiet a scene to show anything";
    EXPECT_GT(bed.largestSpeed(), 0.05);
    if (expected.empty()) {
      expected = hashes;
    }
    EXPECT_EQ(hashes, expected) << threads << " threads";
  }
}

TEST(Determinism, SameHashForAnyNumberOfThreadsWhereSoilIsManyCellsDeep) {
  // Several threads then share it out in another order than that of its numbers.
  std::vector<std::size_t> expected;
  for (const int threads : {1, 2, 3}) {
    BedParameters parameters = largeBed(threads);
    parameters.soil.friction = FrictionModel::kContact;
    parameters.width_m = parameters.length_m = 0.2;
    parameters.depth_m = 0.12;
    parameters.sleep_speed_m_s = 2e-3;
    Bed bed(parameters);
    ASSERT_GT(bed.particles(), 3U * 512);
    std::vector<std::size_t> hashes;
    const auto look = [&](int steps) {
      for (int step = 0; step < steps; ++step) {
        run(bed, 1);
        if (step % 50 == 0) {
          hashes.push_back(std::hash<std::string>{}(serialise(bed.state())));  // and the order of lists
        }
      }
    };
    look(400);
    bed.setGravity({4, 3, -2});  // it flows to a corner
    look(400);
    bed.setGravity({0, 0, -1.62});
    look(600);
    EXPECT_GT(bed.listRebuilds(), bed.particles()) << "too quiet a scene to show anything";
    expected = expected.empty() ? hashes : expected;
    EXPECT_EQ(hashes, expected) << threads << " threads";
  }
}

TEST(Determinism, ASavedBedGoesOnBitForBit) {
  Bed bed = tippedBed(1);
  run(bed, 150);
  // Saved at any time.
  for (const int later : {0, 1, 5, 9}) {
    run(bed, later);
    const std::string saved = serialise(bed.state());

    Bed restored = tippedBed(2);
    run(restored, 3);  // whatever it did before
    restored.restore(deserialiseBedState(saved));
    ASSERT_EQ(stateHash(restored.state()), stateHash(bed.state()));
    run(bed, 150);
    run(restored, 150);
    EXPECT_EQ(stateHash(restored.state()), stateHash(bed.state())) << later;
  }
}

TEST(Determinism, ASmallBedGoesOnBitForBitFor500Steps) {
  BedParameters parameters;
  parameters.soil = findPreset("P1").soil;
  Bed bed(parameters);
  BedState kicked = bed.state();
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    kicked.velocity[i] = {i % 3 == 0 ? 0.5F : -0.3F, i % 5 == 0 ? 0.4F : -0.1F, i % 2 == 0 ? 0.6F : 0.1F, 0};
  }
  bed.restore(kicked);
  run(bed, 77);
  const BedState saved = deserialiseBedState(serialise(bed.state()));
  Bed restored(parameters);
  restored.restore(saved);
  for (int i = 0; i < 500; ++i) {
    run(bed, 1);
    run(restored, 1);
    ASSERT_EQ(stateHash(restored.state()), stateHash(bed.state())) << i;
  }
}

/// A bed that has just been restored knows of no rows that may be left out, and goes through all of them.
class RowsThatAreLeftOut : public EveryTarget, public testing::WithParamInterface<FrictionModel> {};

TEST_P(RowsThatAreLeftOut, HoldNobodyWhoTouches) {
  forEachTarget([] {
    BedParameters parameters;
    parameters.soil = findPreset("P1").soil;
    if (GetParam() == FrictionModel::kContact) {
      parameters.soil.friction = FrictionModel::kContact;
      parameters.soil.stiffness_n_m = 3000;
      parameters.soil.contact_cohesion_n = 0.2;
      parameters.soil.size_spread = 0.15;
    }
    Bed bed(parameters);
    Bed all_rows(parameters);
    BedState kicked = bed.state();
    for (std::size_t i = 0; i < bed.particles(); ++i) {
      kicked.velocity[i] = {i % 3 == 0 ? 0.8F : -0.5F, i % 5 == 0 ? 0.6F : -0.2F, i % 2 == 0 ? 1.5F : 0.1F, 0};
    }
    bed.restore(kicked);
    const double dt_s = kTick_s / substepsFor(parameters.soil, 0, kTick_s, 32);
    for (int i = 0; i < 600; ++i) {
      all_rows.restore(bed.state());
      ASSERT_EQ(all_rows.step(dt_s), StepStatus::kOk);
      ASSERT_EQ(bed.step(dt_s), StepStatus::kOk);
      ASSERT_EQ(stateHash(bed.state()), stateHash(all_rows.state())) << "after step " << i;
    }
    EXPECT_GT(bed.listRebuilds(), bed.particles()) << "too quiet to show anything";
  });
}
INSTANTIATE_TEST_SUITE_P(Determinism, RowsThatAreLeftOut,
                         testing::Values(FrictionModel::kIcra2021, FrictionModel::kContact), [](const auto& test) {
                           return test.param == FrictionModel::kIcra2021 ? "Icra2021" : "Contact";
                         });

TEST(Determinism, RainDependsOnTheSeedAndOnNothingElse) {
  BedParameters parameters;
  parameters.soil = findPreset("P4").soil;
  parameters.start = BedStart::kRain;
  parameters.particles = 200;
  parameters.seed = 5;
  const std::uint64_t hash = stateHash(Bed(parameters).state());
  EXPECT_EQ(stateHash(Bed(parameters).state()), hash);
  parameters.seed = 6;
  EXPECT_NE(stateHash(Bed(parameters).state()), hash);
}

}  // namespace
}  // namespace haptolith

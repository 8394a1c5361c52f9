#include "haptolith/identify/model_learner.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

namespace haptolith {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kDensity_kg_m3 = 1500, kMoon_m_s2 = 1.625;
constexpr SoilState kModel{42, 500, 0.36}, kTruth{34, 150, 0.5};

ModelLearner learner() {
  return {{.middle = kModel}, kDensity_kg_m3, kMoon_m_s2};
}

ToolCut cutAt(double depth_m, double rake_deg) {
  return {.depth_m = depth_m, .rake_rad = rake_deg * kDegree};
}

double delta(const SoilState& state) {
  return std::atan(state.tool_friction);
}

/// Force on a 40 mm blade in a soil of the equation: back, and up by soil that slides along it.
Vec3 forceOf(const ToolCut& cut, const SoilState& state) {
  const double pushed_rad = cut.rake_rad + delta(state);
  return 0.04 * learner().forceAlong(cut, state) * Vec3(-std::sin(pushed_rad), 0, -std::cos(pushed_rad));
}

DiggingStretch stretchAt(const Vec3& place_m, const ToolCut& cut, const SoilState& model, const SoilState& truth) {
  return {place_m, cut, model, forceOf(cut, model), forceOf(cut, truth)};
}

TEST(ModelLearner, KnowsWhatItBeganWithBeforeAnythingWasMet) {
  const ModelSoil soil = learner().at(Vec3::Zero());
  EXPECT_NEAR(soil.state.friction_angle_deg, 42, 1e-9);
  EXPECT_NEAR(soil.state.cohesion_pa, 500, 1e-6);
  EXPECT_NEAR(soil.state.tool_friction, 0.36, 1e-12);
  EXPECT_EQ(soil.stretches, 0);
  EXPECT_GT(soil.friction_angle_deg.high - soil.friction_angle_deg.low, 20);
}

TEST(ModelLearner, FindsTheSoilFromCutsOfDifferentDepthsAndRakes) {
  ModelLearner learns = learner();
  for (int i = 0; i < 40; ++i) {
    learns.add(stretchAt(Vec3::Zero(), cutAt(0.01 + 0.002 * (i % 20), i % 2 == 0 ? 80 : 50), kModel, kTruth));
  }
  const ModelSoil soil = learns.at(Vec3::Zero());
  EXPECT_NEAR(soil.state.friction_angle_deg, 34, 5) << "it began 8 degrees off";
  EXPECT_NEAR(soil.state.cohesion_pa, 150, 50);
  EXPECT_NEAR(std::atan(soil.state.tool_friction) / kDegree, delta(kTruth) / kDegree, 4);
  EXPECT_TRUE(holds(soil.friction_angle_deg, 34));
  EXPECT_TRUE(holds(soil.cohesion_pa, 150));
  EXPECT_TRUE(holds(soil.tool_friction_angle_deg, delta(kTruth) / kDegree));
}

// At one depth, friction and cohesion are indistinguishable; the force is not.
TEST(ModelLearner, GivesTheForceThatWasMetAtOneDepth) {
  for (const SoilState& truth : {kTruth, SoilState{48, 1200, 0.2}, SoilState{25, 10, 0.36}}) {
    ModelLearner learns = learner();
    const ToolCut cut = cutAt(0.035, 70);
    SoilState model = kModel;
    for (int round = 0; round < 3; ++round) {  // each time in a model that has become what was learned
      for (int i = 0; i < 10; ++i) {
        learns.add(stretchAt(Vec3::Zero(), cut, model, truth));
      }
      model = learns.at(Vec3::Zero()).state;
    }
    constexpr double kNoise_n = 0.05;
    EXPECT_LT((forceOf(cut, model) - forceOf(cut, truth)).norm(), 0.06 * forceOf(cut, truth).norm() + kNoise_n);
  }
}

TEST(ModelLearner, KnowsOneSoilHereAndAnotherThere) {
  ModelLearner learns = learner();
  const SoilState loose{30, 60, 0.36}, firm{46, 900, 0.36};
  const Vec3 here(-0.2, 0, 0), there(0.2, 0, 0);
  for (int i = 0; i < 30; ++i) {
    const ToolCut cut = cutAt(0.015 + 0.001 * i, 80);
    learns.add(stretchAt(here, cut, kModel, loose));
    learns.add(stretchAt(there, cut, kModel, firm));
  }
  const ToolCut cut = cutAt(0.03, 80);
  EXPECT_NEAR(learns.forceAlong(cut, learns.at(here).state) / learns.forceAlong(cut, loose), 1, 0.2);
  EXPECT_NEAR(learns.forceAlong(cut, learns.at(there).state) / learns.forceAlong(cut, firm), 1, 0.2);
}

TEST(ModelLearner, IsNotLedAstrayByAFewStretchesThatMetAStone) {
  ModelLearner learns = learner();
  const ToolCut cut = cutAt(0.03, 80);
  for (int i = 0; i < 40; ++i) {
    DiggingStretch stretch = stretchAt(Vec3::Zero(), cut, kModel, kTruth);
    stretch.met_n *= i % 10 == 0 ? 10 : 1;
    learns.add(stretch);
  }
  EXPECT_NEAR(learns.forceAlong(cut, learns.at(Vec3::Zero()).state) / learns.forceAlong(cut, kTruth), 1, 0.1);
}

TEST(ModelLearner, RemembersOnlySoManyStretchesAndForgetsTheOldest) {
  ModelLearner learns = learner();
  const ToolCut cut = cutAt(0.03, 80);
  for (std::size_t i = 0; i < ModelLearner::kMostStretches; ++i) {
    learns.add(stretchAt(Vec3::Zero(), cut, kModel, kModel));
  }
  for (std::size_t i = 0; i < ModelLearner::kMostStretches; ++i) {
    learns.add(stretchAt(Vec3::Zero(), cut, kModel, kTruth));
  }
  EXPECT_EQ(learns.stretches(), ModelLearner::kMostStretches);
  EXPECT_NEAR(learns.forceAlong(cut, learns.at(Vec3::Zero()).state) / learns.forceAlong(cut, kTruth), 1, 0.05);
}

// Truths drawn from the prior, forces that scatter as two specimens do, two stretches alike: nine intervals in ten
// hold.
TEST(ModelLearner, NineIntervalsInTenHoldTheTruth) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  constexpr int kTrials = 120;
  int held = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const SoilState truth{std::clamp(35 + 8 * normal(random), 15.0, 49.0), 200 * std::exp(0.7 * normal(random)),
                          std::clamp(0.36 + 0.1 * normal(random), 0.08, 0.65)};
    ModelLearner learns({.middle = {35, 200, 0.36}}, kDensity_kg_m3, kMoon_m_s2);
    for (int i = 0; i < 15; ++i) {
      DiggingStretch stretch =
          stretchAt(Vec3::Zero(), cutAt(0.012 + 0.002 * i, i % 2 == 0 ? 80 : 55), {35, 200, 0.36}, truth);
      const double size_n = std::max(stretch.met_n.norm(), stretch.displayed_n.norm());
      stretch.met_n += 0.2 * size_n * Vec3(normal(random), normal(random), normal(random));
      learns.add(stretch);
      learns.add(stretch);
    }
    const ModelSoil soil = learns.at(Vec3::Zero());
    held += holds(soil.friction_angle_deg, truth.friction_angle_deg) ? 1 : 0;
    held += holds(soil.cohesion_pa, truth.cohesion_pa) ? 1 : 0;
    held += holds(soil.tool_friction_angle_deg, delta(truth) / kDegree) ? 1 : 0;
  }
  const double share = held / (3.0 * kTrials);
  EXPECT_GT(share, 0.85);
  EXPECT_LT(share, 0.98);
}

}  // namespace
}  // namespace haptolith

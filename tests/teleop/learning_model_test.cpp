#include "haptolith/teleop/operator/learning_model.h"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "haptolith/identify/training/training_file.h"

namespace haptolith {
namespace {

const StrengthMap& strengths() {
  static const StrengthMap kStrengths(probeTraining().runs);
  return kStrengths;
}

/// A blade 35 mm deep that moves steadily at 30 mm/s; from a distance on the remote force is `met` times the displayed
/// one.
class Cutting {
 public:
  explicit Cutting(LearningModel& model, const Vec3& displayed_n = {-10, 0, 1}) : felt_n_(displayed_n), model_(model) {}

  /// The robot's report of 20 ticks, which comes `late` ticks later than it happens.
  void report(std::uint64_t index, double met, std::uint64_t late = 0) {
    RobotReport report;
    report.index = index;
    report.ticks = 20;
    report.pose = {{3e-5 * static_cast<double>(index), 0, -0.01}, Quat(Eigen::AngleAxisd(1.5, Vec3::UnitY()))};
    report.met.force_n = met * felt_n_;
    waiting_.push_back({index + late, report});
  }
  /// Advances to a tick, and records all steps on the way.
  void goOn(std::uint64_t to, bool in_air = false) {
    for (; now_ < to; ++now_) {
      for (; !waiting_.empty() && waiting_.front().arrives <= now_; waiting_.erase(waiting_.begin())) {
        model_.met(waiting_.front().report, felt_n_);
      }
      if (const auto step = model_.at(now_, in_air)) {
        steps.push_back(*step);
      }
    }
  }

  std::vector<SoilAdjustment> steps;

 private:
  struct Waiting {
    std::uint64_t arrives;
    RobotReport report;
  };
  Vec3 felt_n_;
  LearningModel& model_;
  std::vector<Waiting> waiting_;
  std::uint64_t now_ = 0;
};

SceneFile digModel() {
  return readyToLearn(findSceneFile("teleop-model"));
}

TEST(LearningModel, StaysAsItIsWhileNothingIsMetOrAllIsAsItWasFelt) {
  LearningModel model(digModel(), strengths());
  Cutting cutting(model);
  cutting.goOn(3000);
  EXPECT_TRUE(cutting.steps.empty());
  EXPECT_EQ(model.updates(), 0U);
  for (std::uint64_t index = 3020; index <= 6000; index += 20) {
    cutting.report(index, 1);
  }
  cutting.goOn(6500);
  EXPECT_TRUE(cutting.steps.empty()) << "the tool is in soil";
  cutting.goOn(8000, true);
  ASSERT_FALSE(cutting.steps.empty());
  const SceneFile was = digModel();
  EXPECT_NEAR(cutting.steps.back().contact_friction, was.bed.soil.contact_friction, 0.02);
  EXPECT_NEAR(cutting.steps.back().contact_cohesion_n / was.bed.soil.contact_cohesion_n, 1, 0.1);
  EXPECT_NEAR(cutting.steps.back().tool_friction, was.tool.friction, 0.02);
}

TEST(LearningModel, BecomesWeakerWhileTheToolIsLiftedOrInStepsThatNobodyFeels) {
  LearningModel model(digModel(), strengths());
  const SoilState first = model.state();
  Cutting cutting(model);
  for (std::uint64_t index = 20; index <= 4000; index += 20) {
    cutting.report(index, 0.4, 850);
  }
  cutting.goOn(LearningModel::kLongStrokeTicks);
  EXPECT_GE(model.updates(), 3U);
  EXPECT_TRUE(cutting.steps.empty());
  cutting.goOn(LearningModel::kLongStrokeTicks + 3000);
  ASSERT_GT(cutting.steps.size(), 100U) << "a stroke of more than ten seconds";
  const std::size_t in_soil = cutting.steps.size();
  cutting.goOn(LearningModel::kLongStrokeTicks + 4000, true);
  EXPECT_LT(cutting.steps.size(), in_soil + 50) << "then it is soon there";
  EXPECT_LT(cutting.steps.back().contact_cohesion_n, 0.8 * digModel().bed.soil.contact_cohesion_n);
  const ModelLearner law({.middle = first}, digModel().bed.soil.rho0_kg_m3, 1.625);
  const ToolCut cut{.depth_m = 0.035, .rake_rad = 1.4};
  const auto force_after = [&](const SoilAdjustment& step) {
    const ShearStrength strength = strengths().of(step.of(digModel().bed.soil));
    return law.forceAlong(cut, {strength.angle_deg, strength.cohesion_pa, step.tool_friction});
  };
  EXPECT_NEAR(std::log(force_after(cutting.steps[in_soil - 1]) / law.forceAlong(cut, first)), -0.3, 0.15);
  for (std::size_t i = 1; i < in_soil; ++i) {
    EXPECT_LT(std::abs(std::log(force_after(cutting.steps[i]) / force_after(cutting.steps[i - 1]))), 0.01) << i;
  }
  EXPECT_NEAR(law.forceAlong(cut, model.learned().state) / law.forceAlong(cut, first), 0.4, 0.1)
      << "each stretch was felt in soil that was not weaker yet";
}

// A penetrating edge is pushed up by soil. That force depends on strength differently from the force of a cut.
TEST(LearningModel, LearnsFromCutsAlone) {
  for (const Vec3& displayed_n : {Vec3(0, 0, 8), Vec3(4, 0, 10), Vec3(-5, 0, 8), Vec3(0, 8, 0)}) {
    LearningModel model(digModel(), strengths());
    Cutting cutting(model, displayed_n);
    for (std::uint64_t index = 20; index <= 4000; index += 20) {
      cutting.report(index, 0.4);
    }
    cutting.goOn(6000);
    EXPECT_EQ(model.updates(), 0U) << displayed_n.transpose();
  }
}

TEST(LearningModel, AStepThatIsRefusedComesAgain) {
  LearningModel model(digModel(), strengths());
  Cutting cutting(model);
  for (std::uint64_t index = 20; index <= 1600; index += 20) {
    cutting.report(index, 0.4);
  }
  cutting.goOn(1650);
  cutting.goOn(1970, true);
  const SoilState was = model.state();
  const auto step = model.at(1980, true);
  ASSERT_TRUE(step);
  EXPECT_NE(model.state().cohesion_pa, was.cohesion_pa);
  model.refused();
  EXPECT_EQ(model.state().cohesion_pa, was.cohesion_pa) << "the soil is as it was";
  const auto again = model.at(2000, true);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->contact_cohesion_n, step->contact_cohesion_n);
}

TEST(LearningModel, ReportsMayOvertakeEachOtherAndComeLate) {
  LearningModel in_order(digModel(), strengths()), mixed(digModel(), strengths());
  Cutting one(in_order), other(mixed);
  for (std::uint64_t index = 20; index <= 4000; index += 40) {
    one.report(index, 0.5);
    one.report(index + 20, 0.5);
    other.report(index + 20, 0.5);
    other.report(index, 0.5);
  }
  one.goOn(6000);
  other.goOn(6000);
  EXPECT_NEAR(in_order.learned().state.friction_angle_deg, mixed.learned().state.friction_angle_deg, 0.5);
  EXPECT_NEAR(in_order.learned().state.cohesion_pa / mixed.learned().state.cohesion_pa, 1, 0.05);
}

TEST(LearningModel, ThinkingBesideTheLoopComesToTheSame) {
  LearningModel at_once(digModel(), strengths()), beside(digModel(), strengths(), Work::kBeside);
  Cutting one(at_once), other(beside);
  for (std::uint64_t index = 20; index <= 1000; index += 20) {
    one.report(index, 0.5);
    other.report(index, 0.5);
  }
  one.goOn(1600);
  other.goOn(1600);
  for (std::uint64_t tick = 1600; beside.updates() == 0 && tick < 100'000'000; ++tick) {
    other.goOn(tick);
  }
  EXPECT_EQ(at_once.learned().state.cohesion_pa, beside.learned().state.cohesion_pa);
}

TEST(LearningModel, SoilWithoutCohesionMayGetSomeAndIcra2021FrictionIsRefused) {
  SceneFile sand = findSceneFile("teleop-model");
  sand.bed.soil.contact_cohesion_n = 0;
  EXPECT_GT(readyToLearn(sand).bed.soil.contact_cohesion_n, 0);
  EXPECT_LT(readyToLearn(sand).bed.soil.contact_cohesion_n, 1e-5);
  EXPECT_FALSE(canLearn(findSceneFile("icra2021")));
  EXPECT_THROW((void)readyToLearn(findSceneFile("icra2021")), InvalidParameter);
}

}  // namespace
}  // namespace haptolith

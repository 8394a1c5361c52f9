#include "haptolith/teleop/operator/site_probe.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "haptolith/identify/training/training_file.h"

namespace haptolith {
namespace {

/// Grains of 6 mm, of which there are fewer: 35.3 degrees and 158 Pa by their own shear tests.
SceneFile siteOfCoarseGrains() {
  const std::vector<std::string> coarse{"soil.radius_mm=6", "soil.stiffness_n_m=4000"};
  return findSceneFile("teleop-site", coarse);
}

TEST(SiteProbe, ARobotTellsTheSoilOfItsSite) {
  const SceneFile site = siteOfCoarseGrains();
  const Training& training = probeTraining();
  const ProbedSoil probed = probeSite(site, {}, training);
  EXPECT_GE(probed.windows, probed.of_windows * 9 / 10) << "its arm yields";
  EXPECT_TRUE(holds(probed.belief.friction_angle_deg, 35.3)) << probed.belief.friction_angle_deg.middle;
  EXPECT_TRUE(holds(probed.belief.cohesion_pa, 158)) << probed.belief.cohesion_pa.middle;
  const double tool_deg = std::atan(site.tool.friction) * 180 / std::numbers::pi;
  EXPECT_TRUE(holds(probed.belief.tool_friction_angle_deg, tool_deg)) << probed.belief.tool_friction_angle_deg.middle;
  EXPECT_LT(probed.belief.misfit, kStrange);

  const StrengthMap strengths(training.runs);
  const SceneFile model = findSceneFile("teleop-model");
  const SceneFile better = withBelievedSoil(model, probed.belief, strengths);
  EXPECT_EQ(better.bed.soil.radius_m, model.bed.soil.radius_m) << "the operator's own grains";
  EXPECT_NEAR(strengths.of(better.bed.soil).angle_deg, probed.belief.friction_angle_deg.middle, 0.1);
  EXPECT_NEAR(strengths.of(better.bed.soil).cohesion_pa, probed.belief.cohesion_pa.middle, 1);
  EXPECT_NO_THROW(validate(better));
  EXPECT_THROW((void)withBelievedSoil(findSceneFile("icra2021"), probed.belief, strengths), InvalidParameter);
}

TEST(SiteProbe, EndsWhereNobodyWantsIt) {
  EXPECT_THROW(
      (void)probeSite(siteOfCoarseGrains(), {}, probeTraining(), [](std::string_view, double) { return false; }),
      Failure);
}

}  // namespace
}  // namespace haptolith

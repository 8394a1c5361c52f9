#include "haptolith/lab/tests/payload.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

LabConditions withContactFriction() {
  LabConditions conditions;
  conditions.soil.friction = FrictionModel::kContact;
  conditions.soil.stiffness_n_m = 1000;
  conditions.soil.size_spread = 0.1;
  return conditions;
}

TEST(PayloadTest, AHandFeelsTheWeightAndTheInertiaOfSoilAndNothingElse) {
  for (const double cohesion : {0.0, 0.01}) {
    LabConditions conditions = withContactFriction();
    conditions.soil.contact_cohesion_n = cohesion;
    const PayloadResult result = payloadTest(conditions);
    EXPECT_GT(result.carried_kg, 100 * macroparticleMass(conditions.soil)) << "hardly a heap";
    EXPECT_NEAR(result.left_kg, result.carried_kg, 0.05 * result.carried_kg);
    EXPECT_NEAR(result.weight_ratio, 1, 0.03);
    EXPECT_NEAR(result.drag_ratio, 0, 0.03);
    EXPECT_NEAR(result.follow_ratio, 1, 0.03);
    EXPECT_NEAR(result.shake_ratio, 1, 0.05);
  }
}

TEST(PayloadTest, WithIcra2021FrictionSoilHangsInSpaceAndStaysBehind) {
  LabConditions conditions;
  conditions.soil = findPreset("P4").soil;
  const PayloadResult result = payloadTest(conditions);
  // Measured: 0.46 of the weight, and 0.004 of the way.
  EXPECT_LT(result.weight_ratio, 0.9);
  EXPECT_LT(result.follow_ratio, 0.5);
}

TEST(PayloadTest, DrawsItsFigure) {
  PayloadResult result;
  result.trace.rows = {{1, 0.5, 0, 0.5, 0, 0}, {1.1, 0.51, 0.01, 0.5, 0.1, 0}, {1.2, 0.5, 0, 0.5, 0.1, 0}};
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "carry.svg";
  drawPayload(path, result, "a heap");
  EXPECT_GT(std::filesystem::file_size(path), 1000U);
  std::filesystem::remove(path);
}

TEST(PayloadTest, RefusesNonsense) {
  LabConditions conditions = withContactFriction();
  EXPECT_THROW((void)payloadTest(conditions, {.particles = 0}), InvalidParameter);
  EXPECT_THROW((void)payloadTest(conditions, {.shovel_radii = 1}), InvalidParameter);
  EXPECT_THROW((void)payloadTest(conditions, {.shake_g = 2}), InvalidParameter);
  conditions.gravity_m_s2 = 0;
  EXPECT_THROW((void)payloadTest(conditions), InvalidParameter);
}

}  // namespace
}  // namespace haptolith

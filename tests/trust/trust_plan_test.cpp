#include "haptolith/trust/trust_plan.h"

#include <gmock/gmock.h>

#include <array>
#include <string>
#include <vector>

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

SceneFile changedBy(TrustChange change, const SceneFile& scene, double radius_ratio = 1) {
  const PlannedRun plan = planned(scene, change, 0, radius_ratio);
  EXPECT_TRUE(plan.run) << plan.why_not;
  SceneFile changed_scene = plan.run->scene;
  changed_scene.bed.max_substeps = scene.bed.max_substeps;
  return changed_scene;
}

SceneFile set(const SceneFile& scene, const std::vector<std::string>& overrides) {
  return changed(scene, overrides);
}

// The user can make the compared scenes with --set.
TEST(TrustPlan, ChangesAreThoseOfKeys) {
  const SceneFile settled = findSceneFile("regolith");
  EXPECT_EQ(changedBy(TrustChange::kNone, settled), settled);
  EXPECT_EQ(changedBy(TrustChange::kWideX, settled), set(settled, {"bed.width_mm=252"}));
  EXPECT_EQ(changedBy(TrustChange::kWideY, settled), set(settled, {"bed.length_mm=252"}));
  EXPECT_EQ(changedBy(TrustChange::kDeep, settled), set(settled, {"bed.depth_mm=70"}));
  EXPECT_EQ(changedBy(TrustChange::kAwake, settled), set(settled, {"bed.sleep=false"}));
  const SceneFile finer = changedBy(TrustChange::kRadius, settled, 0.5), wanted = set(settled, {"soil.radius_mm=1.75"});
  EXPECT_DOUBLE_EQ(finer.bed.soil.radius_m, wanted.bed.soil.radius_m);
  EXPECT_DOUBLE_EQ(finer.bed.soil.stiffness_n_m, wanted.bed.soil.stiffness_n_m);
  EXPECT_DOUBLE_EQ(finer.bed.soil.gamma_nm, wanted.bed.soil.gamma_nm);
  EXPECT_DOUBLE_EQ(finer.bed.soil.contact_cohesion_n, wanted.bed.soil.contact_cohesion_n);
  EXPECT_EQ(finer.tool, wanted.tool);

  const SceneFile counted = findSceneFile("icra2021");
  EXPECT_EQ(changedBy(TrustChange::kWideX, counted), set(counted, {"bed.width_mm=252", "bed.particles=512"}));
  EXPECT_EQ(changedBy(TrustChange::kDeep, counted), set(counted, {"bed.layers=6", "bed.particles=512"}));
  EXPECT_EQ(changedBy(TrustChange::kRadius, counted, 0.5).bed.particles, 2048);
  EXPECT_EQ(changedBy(TrustChange::kRadius, counted, 0.5).bed.layers, 6);
}

TEST(TrustPlan, SpecimensDifferBySeedOrByThePlaceOfTheTool) {
  const SceneFile settled = findSceneFile("regolith"), packed = findSceneFile("deep-bed");
  EXPECT_TRUE(hasSeed(settled));
  const PlannedRun seeded = planned(settled, TrustChange::kWideX, 3);
  EXPECT_EQ(seeded.run->scene.bed.seed, settled.bed.seed + 3);
  EXPECT_TRUE(seeded.run->shift_m.isZero());

  EXPECT_FALSE(hasSeed(packed));
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < 10; ++i) {
    const Vec3 place_m = planned(packed, TrustChange::kNone, i).run->shift_m;
    EXPECT_LE(place_m.lpNorm<Eigen::Infinity>(), packed.bed.soil.radius_m);
    EXPECT_EQ(place_m.z(), 0);
    for (const Vec3& other : places) {
      EXPECT_GT((place_m - other).norm(), 0.1 * packed.bed.soil.radius_m);
    }
    places.push_back(place_m);
  }
  EXPECT_TRUE(places.front().isZero()) << "the scene itself is the first";
}

TEST(TrustPlan, SaysWhatCannotBeChanged) {
  SceneFile given = findSceneFile("icra2021");
  given.bed.start = BedStart::kGiven;
  for (const TrustChange change : {TrustChange::kWideX, TrustChange::kDeep, TrustChange::kRadius}) {
    EXPECT_THAT(planned(given, change, 0, 0.5).why_not, HasSubstr("given places"));
  }
  SceneFile awake = findSceneFile("icra2021");
  awake.bed.sleep = false;
  EXPECT_THAT(planned(awake, TrustChange::kAwake, 0).why_not, HasSubstr("no particle may sleep"));
  EXPECT_THAT(planned(findSceneFile("jaws"), TrustChange::kMesh, 0).why_not, HasSubstr("no mesh"));
}

TEST(TrustPlan, AMeshHasTheSizeOfItsShape) {
  for (const char* shape : {"tool.shape='box'", "tool.shape='plate'", "tool.shape='sphere'", "tool.shape='cylinder'"}) {
    const SceneFile scene = set(findSceneFile("icra2021"), {shape});
    const SceneFile drawn = changedBy(TrustChange::kMesh, scene);
    EXPECT_EQ(drawn.tool.shape, ToolShape::kMesh) << shape;
    EXPECT_TRUE(drawn.tool.mesh) << shape;
  }
}

TEST(TrustPlan, NamesAreUnique) {
  std::vector<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(TrustChange::kMesh); ++i) {
    const auto change = static_cast<TrustChange>(i);
    EXPECT_THAT(names, Not(testing::Contains(nameOf(change))));
    EXPECT_THAT(titleOf(change, 0.5), Not(IsEmpty()));
    EXPECT_GT(relativeCost(change, 0.5), 0);
    names.push_back(nameOf(change));
  }
}

}  // namespace
}  // namespace haptolith

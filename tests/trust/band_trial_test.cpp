#include "haptolith/trust/band_trial.h"

#include <gmock/gmock.h>

#include <set>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/trust/trust_plan.h"

namespace haptolith {
namespace {

TEST(BandTrial, ScenesAreValidDifferentAndAlwaysTheSame) {
  std::set<std::string> texts;
  for (std::uint64_t number = 0; number < 60; ++number) {
    const SceneFile scene = bandScene(number);
    EXPECT_EQ(scene, bandScene(number));
    EXPECT_TRUE(planned(scene, TrustChange::kRadius, 10, 0.5).run) << number;
    texts.insert(sceneFileText(scene));
  }
  EXPECT_EQ(texts.size(), 60U);
  EXPECT_NE(bandScene(1).bed.seed, bandScene(151).bed.seed) << "another bed";
  EXPECT_EQ(bandScene(1).bed.soil, bandScene(151).bed.soil);
}

TEST(BandTrial, KnowsBandAndReferenceInEachWindow) {
  SceneFile scene = bandScene(12);  // soft sand on the Moon
  scene.bed.depth_m = 0.02;         // settles sooner
  scene.hand.period_s = 1.5;
  const std::vector<BandWindow> windows = bandTrial(scene, 2);
  ASSERT_FALSE(windows.empty());
  EXPECT_LE(windows.size(), 6U);
  for (const BandWindow& window : windows) {
    EXPECT_GT(std::max(window.mean.force_n, window.reference_n), window.particle_n / 2);
    EXPECT_LE(window.band.low_n, window.band.high_n);
  }
  EXPECT_THROW((void)bandTrial(scene, 1, [](std::string_view, double) { return false; }), Failure);
}

}  // namespace
}  // namespace haptolith

#include "haptolith/identify/weighed_scoop.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/core/math/random.h"
#include "haptolith/identify/soil_belief.h"
#include "haptolith/identify/training/soil_sample.h"
#include "haptolith/identify/training/tool_movement.h"
#include "haptolith/scene/scene.h"
#include "haptolith/soil/contact_strength.h"
#include "haptolith/tool/tool_mesh.h"

#include "../source_dir.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

constexpr double kMoon_m_s2 = 1.625;

/// A sensor's force at a scoop that is empty until 4 s, full until 8 s, then empty again; noise that is alike over
/// `memory_s`.
std::vector<MeasuredSample> weighed(double mass_kg, double memory_s, double drift_n_s, std::uint64_t seed) {
  constexpr double kStep_s = 0.002, kNoise_n = 0.05;
  std::mt19937_64 random(seed);
  std::vector<MeasuredSample> samples;
  const double stays = std::exp(-kStep_s / memory_s);
  double noise_n = kNoise_n * nearlyNormal(random);
  for (int i = 0; i * kStep_s <= 12; ++i) {
    const double time_s = i * kStep_s;
    noise_n = stays * noise_n + std::sqrt(1 - stays * stays) * kNoise_n * nearlyNormal(random);
    const double load_n = time_s > 4 && time_s < 8 ? mass_kg * kMoon_m_s2 : 0;
    samples.push_back({time_s, {}, Vec3(0.3, 0, 0.8 - load_n + noise_n + drift_n_s * time_s)});
  }
  return samples;
}

constexpr double kMass_kg = 0.066;

// Noise from reading to reading, and such as lasts: the interval of a mean that took each reading for new would be far
// too narrow for it.
TEST(WeighedScoop, IntervalsHoldNineTimesInTen) {
  for (const double memory_s : {1e-4, 0.02}) {
    constexpr int kTries = 1000;
    int held = 0;
    for (int i = 0; i < kTries; ++i) {
      const SoilEstimate mass_kg = massOf(
          weighScoop(weighed(kMass_kg, memory_s, 0, 100U + unsigned(i)), {{0.5, 3.5}, {4.5, 7.5}, {}, 0}, kMoon_m_s2));
      held += holds(mass_kg, kMass_kg) ? 1 : 0;
    }
    EXPECT_NEAR(held / double(kTries), 0.9, 0.03) << memory_s;
  }
}

TEST(WeighedScoop, ADriftIsInterpolatedOrAllowedFor) {
  constexpr double kDrift_n_s = 5e-3;
  const std::vector<MeasuredSample> samples = weighed(kMass_kg, 1e-4, kDrift_n_s, 1);
  const ScoopWeighing once{{0.5, 3.5}, {4.5, 7.5}, {}, 0};
  EXPECT_FALSE(holds(massOf(weighScoop(samples, once, kMoon_m_s2)), kMass_kg));
  ScoopWeighing allowed = once;
  allowed.drift_n_s = kDrift_n_s;
  EXPECT_TRUE(holds(massOf(weighScoop(samples, allowed, kMoon_m_s2)), kMass_kg));
  ScoopWeighing twice = once;
  twice.empty_again_s = Range{8.5, 11.5};
  const ScoopMass mass = weighScoop(samples, twice, kMoon_m_s2);
  EXPECT_TRUE(holds(massOf(mass), kMass_kg));
  EXPECT_LT(mass.mass_kg.error, weighScoop(samples, allowed, kMoon_m_s2).mass_kg.error / 5);
}

TEST(WeighedScoop, DensityHoldsNineTimesInTen) {
  constexpr int kTries = 1000;
  constexpr double kVolume_m3 = 44e-6, kError_m3 = 6e-6;
  std::mt19937_64 random(5);
  int held = 0;
  for (int i = 0; i < kTries; ++i) {
    const ScoopMass mass{{kMass_kg + 2e-3 * nearlyNormal(random), 2e-3}, 1000};
    const SoilEstimate density_kg_m3 = densityOf(mass, {kVolume_m3 + kError_m3 * nearlyNormal(random), kError_m3});
    held += holds(density_kg_m3, kMass_kg / kVolume_m3) ? 1 : 0;
  }
  EXPECT_NEAR(held / double(kTries), 0.9, 0.03);
  const SoilEstimate exact = densityOf({{0.066, 0}, 9}, {44e-6, 0});
  EXPECT_NEAR(exact.low, 1500, 1e-6);
  EXPECT_NEAR(exact.high, 1500, 1e-6);
}

TEST(WeighedScoop, RefusesWhatIsNoWeighing) {
  std::vector<MeasuredSample> samples = weighed(kMass_kg, 1e-4, 0, 1);
  const auto refusal = [&](const ScoopWeighing& weighing) -> std::string {
    try {
      (void)weighScoop(samples, weighing, kMoon_m_s2);
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "taken";
  };
  EXPECT_THAT(refusal({{0.5, 0.7}, {4.5, 7.5}, {}, 0}), HasSubstr("--empty-s"));
  EXPECT_THAT(refusal({{0.5, 3.5}, {14.5, 17.5}, {}, 0}), HasSubstr("--full-s"));
  EXPECT_THAT(refusal({{0.5, 3.5}, {4.5, 7.5}, Range{1, 3}, 0}), HasSubstr("--empty-again-s"));
  EXPECT_THAT(refusal({{0.5, 3.5}, {4.5, 100}, {}, 0}), HasSubstr("within the measured time"));
  EXPECT_THAT(refusal({{0.5, 3.5}, {3, 7.5}, {}, 0}), HasSubstr("at another time than --full-s"));
  samples[2500].pose.position_m.x() = 2e-3;
  EXPECT_THAT(refusal({{0.5, 3.5}, {4.5, 7.5}, {}, 0}), HasSubstr("held still"));
  EXPECT_THROW((void)densityOf({{0.066, 0}, 9}, {44e-6, 30e-6}), InvalidParameter);
  EXPECT_THROW((void)densityOf({{0.066, 0}, 9}, {44e-12, 0}), InvalidParameter) << "cm³ as m³, twice";
  EXPECT_THROW((void)densityOf({{-0.066, 1e-3}, 9}, {44e-6, 0}), Failure) << "lighter full than empty";
}

TEST(WeighedScoop, AsFullAsItWasEmptyHasNoMass) {
  const ScoopMass mass = weighScoop(weighed(0, 1e-4, 0, 1), {{0.5, 3.5}, {4.5, 7.5}, {}, 0}, kMoon_m_s2);
  EXPECT_THROW(requireMeasurable(mass), Failure);
  EXPECT_THROW((void)densityOf(mass, {44e-6, 3e-6}), Failure);
  const ScoopMass full = weighScoop(weighed(kMass_kg, 1e-4, 0, 1), {{0.5, 3.5}, {4.5, 7.5}, {}, 0}, kMoon_m_s2);
  EXPECT_NO_THROW(requireMeasurable(full));
}

// --- a scoop in simulated soil --------------------------------------------------------------------------------------

/// Soil that a scoop took out of a bed.
struct Scooped {
  std::vector<MeasuredSample> samples;
  double mass_kg = 0;             ///< in the scoop
  double bulk_density_kg_m3 = 0;  ///< density of the bed before
};

double massAbove(const Bed& bed, double height_m) {
  const auto grains = std::span(bed.state().position).first(bed.particles());  // equal masses, whatever their size
  return bed.mass() *
         static_cast<double>(std::ranges::count_if(grains, [&](const Float4& grain) { return grain.z > height_m; }));
}

/// The scoop goes down nose first, along, up level, and is held still before and behind that.
Scooped scooped(double depth_m) {
  ToolMeshSource source;
  readInto(source, sourceDir() / "tools/scoop.obj");
  ToolParameters tool;
  tool.shape = ToolShape::kMesh;
  BedParameters parameters;
  parameters.soil = soilSample(3).soil;
  parameters.gravity_m_s2 = {0, 0, -kMoon_m_s2};
  parameters.width_m = 0.28;
  parameters.length_m = 0.22;
  parameters.depth_m = 0.05;
  parameters.start = BedStart::kSettled;
  parameters.sleep_speed_m_s = 0.01;
  parameters.sleep_distance_m = parameters.soil.radius_m / 100;
  tool.mesh = toolMesh(source, 2 * parameters.soil.radius_m);
  Scene scene(parameters, tool);
  const double surface_m = meanSurfaceHeight(scene.bed());
  const auto tilted = [](double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3::UnitY())); };
  const double high_m = surface_m + 0.06, low_m = surface_m + 0.008 - depth_m;
  const ToolMovement movement({{0, {{-0.06, 0, high_m}, tilted(0.35)}},
                               {1.5, {{-0.06, 0, high_m}, tilted(0.35)}},
                               {2.5, {{-0.04, 0, low_m}, tilted(0.35)}},
                               {4, {{0.02, 0, low_m}, tilted(0.1)}},
                               {4.7, {{0.03, 0, low_m + 0.02}, tilted(-0.3)}},
                               {6, {{0.03, 0, high_m}, tilted(-0.3)}},
                               {9, {{0.03, 0, high_m}, tilted(-0.3)}}});
  Scooped result;
  const double lifted_m = surface_m + 0.03;
  // The layer without the loose zones at the walls and the surface.
  const double between_m = 0.6 * surface_m;
  result.bulk_density_kg_m3 = (massAbove(scene.bed(), 0.2 * surface_m) - massAbove(scene.bed(), 0.8 * surface_m)) /
                              (parameters.width_m * parameters.length_m * between_m);
  HandState hand;
  hand.pose = movement.at(0);
  scene.placeTool(hand);
  const double tick_s = parameters.tick_s;
  for (int tick = 1; tick * tick_s <= movement.duration(); ++tick) {
    const Pose before = hand.pose;
    hand.pose = movement.at(tick * tick_s);
    hand.twist = {(hand.pose.position_m - before.position_m) / tick_s,
                  rotationBetween(before.orientation, hand.pose.orientation) / tick_s};
    EXPECT_EQ(scene.tick(hand), StepStatus::kOk);
    result.samples.push_back({tick * tick_s, hand.pose, scene.soilWrench().force_n});
  }
  result.mass_kg = massAbove(scene.bed(), lifted_m);
  return result;
}

TEST(WeighedScoop, WeighsWhatItLifts) {
  for (const double depth_m : {0.012, 0.018}) {
    const Scooped scoop = scooped(depth_m);
    ASSERT_GT(scoop.mass_kg, 0.01);
    const ScoopMass mass = weighScoop(scoop.samples, {{0.2, 1.4}, {7.5, 9}, {}, 0}, kMoon_m_s2);
    EXPECT_NEAR(mass.mass_kg.value / scoop.mass_kg, 1, 0.01);
    const SoilEstimate density_kg_m3 = densityOf(mass, {scoop.mass_kg / scoop.bulk_density_kg_m3, 1e-6});
    EXPECT_TRUE(holds(density_kg_m3, scoop.bulk_density_kg_m3)) << "where its volume is known";
  }
}

}  // namespace
}  // namespace haptolith

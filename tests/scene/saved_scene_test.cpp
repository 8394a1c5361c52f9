#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <random>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/scene/scene.h"

namespace haptolith {
namespace {

BedParameters smallBed(FrictionModel friction) {
  BedParameters bed;
  bed.soil.friction = friction;
  bed.particles = 40;
  bed.layers = 1;
  return bed;
}

HandState at(int tick) {
  HandState hand;
  hand.pose.position_m = {0.02 * std::sin(tick * 0.01), 0.02 * std::cos(tick * 0.01), 0.015};
  return hand;
}

class SavedSceneOf : public testing::TestWithParam<FrictionModel> {};
INSTANTIATE_TEST_SUITE_P(EitherFriction, SavedSceneOf,
                         testing::Values(FrictionModel::kIcra2021, FrictionModel::kContact), [](const auto& param) {
                           return param.param == FrictionModel::kIcra2021 ? "Icra2021" : "Contact";
                         });

TEST_P(SavedSceneOf, BytesComeBackAsTheyWere) {
  const BedParameters bed = smallBed(GetParam());
  Scene scene(bed, {});
  scene.placeTool(at(0));
  for (int tick = 0; tick < 50; ++tick) {
    ASSERT_EQ(scene.tick(at(tick)), StepStatus::kOk);
  }
  const std::string bytes = serialise(scene.save());
  Scene again(bed, {}, deserialiseSavedScene(bytes));
  EXPECT_EQ(serialise(again.save()), bytes);
  EXPECT_EQ(again.soilWrench().force_n, scene.soilWrench().force_n);
  EXPECT_EQ(again.contactStiffness(), scene.contactStiffness());
}

TEST_P(SavedSceneOf, DamageIsRefusedOrBorne) {
  const BedParameters bed = smallBed(GetParam());
  Scene scene(bed, {});
  scene.placeTool(at(0));
  for (int tick = 0; tick < 50; ++tick) {
    ASSERT_EQ(scene.tick(at(tick)), StepStatus::kOk);
  }
  const std::string good = serialise(scene.save());
  std::mt19937 random(1);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  int refused = 0;
  int borne = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = good;
    for (std::size_t k = 0; k <= below(3); ++k) {
      bytes[below(bytes.size())] = static_cast<char>(below(256));
    }
    if (i % 10 == 0) {
      bytes.resize(below(bytes.size()));
    }
    try {
      Scene damaged(bed, {}, deserialiseSavedScene(bytes));
      for (int tick = 50; tick < 60 && damaged.tick(at(tick)) == StepStatus::kOk; ++tick) {
      }
      ++borne;
    } catch (const InvalidParameter&) {
      ++refused;
    } catch (const Failure&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
  EXPECT_GT(borne, 300) << "a last bit of a position hurts nobody: else nothing was tried behind the header";
}

TEST(SavedScene, AToolThatIsNowhereIsRefusedAndNothingHasMoved) {
  Scene scene(smallBed(FrictionModel::kIcra2021), {});
  scene.placeTool(at(0));
  (void)scene.tick(at(1));
  const std::string before = serialise(scene.save());
  for (const auto& spoil : std::initializer_list<void (*)(SavedScene&)>{
           [](SavedScene& saved) { saved.tools[0].hand.pose.position_m.x() = NAN; },
           [](SavedScene& saved) { saved.tools[0].hand.pose.orientation = Quat(0, 0, 0, 0); },
           [](SavedScene& saved) { saved.tools[0].fade = 2; },
           [](SavedScene& saved) { saved.tools[0].hand.opening = -1; },
           [](SavedScene& saved) { saved.tools[0].opening_m = INFINITY; },
           [](SavedScene& saved) { saved.bed.grid_height_m += 1; },
           [](SavedScene& saved) { saved.tools[0].memory.near_groups.push_back(1000); },
           [](SavedScene& saved) { saved.tools[0].memory.particles.emplace_back().particle = 256; },
           [](SavedScene& saved) { saved.tools[0].memory.particles.emplace_back().side = 200; },
           [](SavedScene& saved) { saved.tools[0].memory.particles.emplace_back().slip_m[1] = NAN; },
           [](SavedScene& saved) { saved.tools[0].memory.spheres.emplace_back(); },
           [](SavedScene& saved) { saved.tools.push_back(saved.tools[0]); },
           [](SavedScene& saved) { saved.tools.clear(); },
           [](SavedScene& saved) { saved.tools[0].soil_force.grip_n = NAN; }}) {
    SavedScene saved = scene.save();
    spoil(saved);
    EXPECT_THROW(scene.restore(saved), InvalidParameter);
  }
  EXPECT_EQ(serialise(scene.save()), before);
}

TEST(SavedScene, OfAnotherBedIsRefused) {
  const Scene icra2021(smallBed(FrictionModel::kIcra2021), {});
  Scene contact(smallBed(FrictionModel::kContact), {});
  EXPECT_THROW(contact.restore(icra2021.save()), InvalidParameter);
  EXPECT_THROW((void)Scene(smallBed(FrictionModel::kContact), {}, icra2021.save()), InvalidParameter);
  EXPECT_THROW((void)Scene(smallBed(FrictionModel::kIcra2021), {}, SavedScene{}), InvalidParameter);
}

TEST(IsNearBed, IsTheSpaceOfAHandAtATable) {
  const BedParameters bed = smallBed(FrictionModel::kIcra2021);
  EXPECT_TRUE(isNearBed(bed, {0, 0, 0}));
  EXPECT_TRUE(isNearBed(bed, {bed.width_m / 2 + 0.99, 0, -0.99}));
  EXPECT_FALSE(isNearBed(bed, {bed.width_m / 2 + 1.01, 0, 0}));
  EXPECT_FALSE(isNearBed(bed, {0, 0, 3.01}));
  EXPECT_FALSE(isNearBed(bed, {0, NAN, 0}));
}

}  // namespace
}  // namespace haptolith

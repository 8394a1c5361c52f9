#include <gmock/gmock.h>

#include <string>

#include "use.h"

namespace haptolith::library {
namespace {

using testing::HasSubstr;

struct Told {
  int calls = 0;
  double furthest = 0;
  int give_up_after = 1'000'000'000;
};
std::int32_t tell(void* user, const char* /*what*/, double share) {
  auto& told = *static_cast<Told*>(user);
  told.furthest = std::max(told.furthest, share);
  return ++told.calls < told.give_up_after ? 1 : 0;
}

TEST(LibraryLab, AFallIsAFallWithTheSameNumbersAsTheCommands) {
  const SoilPtr soil = soilOf("lunar-0-15cm");
  hapto_result* made = nullptr;
  Told told;
  expectOk(hapto_lab_test("free-fall", soil.get(), "fall_m = 0.05\nbody = 'Mars'\nthreads = 1\nseed = 3\n", tell, &told,
                          &made));
  const ResultPtr fall(made);
  double ratio = 0;
  expectOk(hapto_result_value(fall.get(), "acceleration_ratio", &ratio));
  EXPECT_NEAR(ratio, 1, 1e-3);
  EXPECT_GT(told.calls, 0);
  const char* json = nullptr;
  expectOk(hapto_result_json(fall.get(), &json));
  EXPECT_THAT(json, HasSubstr(R"("passes":true)"));
  EXPECT_THAT(json, HasSubstr(R"("columns":["time_s","fallen_m","free_fall_m"])"));
  hapto_array fallen{};
  fallen.size = sizeof fallen;
  expectOk(hapto_result_column(fall.get(), "fallen_m", &fallen));
  EXPECT_NEAR(static_cast<const double*>(fallen.data)[fallen.count - 1], 0.05, 0.005);
}

TEST(LibraryLab, OptionsOfOneCallAreNotThoseOfTheNext) {
  const SoilPtr soil = soilOf("dry-sand");
  const auto lastOf = [&](const char* options) {
    hapto_result* made = nullptr;
    expectOk(hapto_lab_test("free-fall", soil.get(), options, nullptr, nullptr, &made));
    const ResultPtr fall(made);
    hapto_array fallen{};
    fallen.size = sizeof fallen;
    expectOk(hapto_result_column(fall.get(), "fallen_m", &fallen));
    return static_cast<const double*>(fallen.data)[fallen.count - 1];
  };
  EXPECT_LT(lastOf("fall_m = 0.05"), 0.1);
  EXPECT_GT(lastOf(nullptr), 0.2);
}

TEST(LibraryLab, AcceptsTheNameOfATestInAnEarlierVersion) {
  const SoilPtr soil = soilOf("dry-sand");
  hapto_result* made = nullptr;
  expectOk(hapto_lab_test("fall", soil.get(), "fall_m = 0.05", nullptr, nullptr, &made));
  const ResultPtr fall(made);
  double ratio = 0;
  expectOk(hapto_result_value(fall.get(), "acceleration_ratio", &ratio));
}

TEST(LibraryLab, WrongOptionsSayWhatWouldBeRight) {
  const SoilPtr soil = soilOf("dry-sand");
  hapto_result* made = nullptr;
  const auto asked = [&](const char* test, const char* options) {
    return hapto_lab_test(test, soil.get(), options, nullptr, nullptr, &made);
  };
  EXPECT_EQ(asked("free-fal", ""), HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().message, HasSubstr("did you mean free-fall?"));
  EXPECT_EQ(asked("free-fall", "fall_n = 3"), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().key, "fall_n");
  EXPECT_THAT(lastError().valid, HasSubstr("did you mean fall_m?"));
  EXPECT_EQ(asked("free-fall", "fall_m = 'far'"), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().valid, "a number");
  EXPECT_EQ(asked("free-fall", "fall_m = 99"), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(asked("free-fall", "threads = 0"), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(asked("free-fall", "body = 'Vulcan'"), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(asked("free-fall", "friction_model = 'none'"), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().valid, "icra2021 or contact");
  EXPECT_EQ(asked("fall", "friction = 'none'"), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().key, "friction_model") << "friction is the name of earlier versions";
  EXPECT_EQ(asked("free-fall", "[fall]"), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(asked("free-fall", "= 3"), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(asked("shear", "normal_pa = [1, 'two']"), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(asked("grain-size", "no_graded = 1"), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(made, nullptr);
}

TEST(LibraryLab, ATestCanBeStopped) {
  const SoilPtr soil = soilOf("dry-sand");
  hapto_result* made = nullptr;
  Told told{.give_up_after = 2};
  EXPECT_EQ(hapto_lab_test("shear", soil.get(), "threads = 1", tell, &told, &made), HAPTO_STOPPED);
  EXPECT_EQ(made, nullptr);
  hapto_soil* calibrated = nullptr;
  told = {.give_up_after = 2};
  EXPECT_EQ(hapto_soil_calibrate("friction_angle_deg = 40\ncohesion_pa = 300\nbulk_density_kg_m3 = 1500", tell, &told,
                                 &calibrated, nullptr),
            HAPTO_STOPPED);
  EXPECT_EQ(hapto_soil_calibrate("friction_angle_deg = 80\ncohesion_pa = 300\nbulk_density_kg_m3 = 1500", nullptr,
                                 nullptr, &calibrated, nullptr),
            HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().valid, HasSubstr("52"));
  EXPECT_EQ(calibrated, nullptr);
}

TEST(LibraryTrust, SaysHowFarAForceCanBeBelieved) {
  const ScenePtr scene = sceneOf("title = 'a shovel in icra2021'");
  const std::uint64_t before = hashOf(scene.get());
  const char* const options = "duration_s = 1\nspecimens = 2\nminutes = 1\nthreads = 2";
  hapto_result* made = nullptr;
  Told told;
  expectOk(hapto_scene_trust(scene.get(), options, tell, &told, &made));
  const ResultPtr verdict(made);
  double within = 0;
  expectOk(hapto_result_value(verdict.get(), "mean_within", &within));
  EXPECT_GT(within, 0);
  EXPECT_GT(told.calls, 0);
  EXPECT_LE(told.furthest, 1);
  const char* json = nullptr;
  expectOk(hapto_result_json(verdict.get(), &json));
  EXPECT_THAT(json, HasSubstr(R"("sentence":")"));
  EXPECT_EQ(hashOf(scene.get()), before) << "the scene itself is left alone";

  told = {.calls = 0, .furthest = 0, .give_up_after = 3};
  EXPECT_EQ(hapto_scene_trust(scene.get(), options, tell, &told, &made), HAPTO_STOPPED);
  EXPECT_EQ(hapto_scene_trust(scene.get(), "specimens = 1", nullptr, nullptr, &made), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_scene_trust(scene.get(), "minutes = nan", nullptr, nullptr, &made), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_scene_trust(scene.get(), "seconds = 1", nullptr, nullptr, &made), HAPTO_INVALID_PARAMETER);
}

}  // namespace
}  // namespace haptolith::library

#include <gmock/gmock.h>

#include <string>

#include "use.h"

namespace haptolith::library {
namespace {

using testing::HasSubstr;

double numberOf(const hapto_soil* soil, const char* key) {
  double number = -1;
  expectOk(hapto_soil_get(soil, key, &number));
  return number;
}

TEST(LibrarySoil, HasTheNumbersOfItsFile) {
  const SoilPtr soil = soilOf("lunar-0-15cm");
  EXPECT_EQ(numberOf(soil.get(), "soil.radius_mm"), 7);
  EXPECT_GT(numberOf(soil.get(), "target.friction_angle_deg"), 35);
  EXPECT_GT(numberOf(soil.get(), "reached.cohesion_pa"), 100);
  double number = 0;
  EXPECT_EQ(hapto_soil_get(soil.get(), "soil.colour", &number), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().value, "'soil.colour'");
  const SoilPtr preset = soilOf("P3");
  EXPECT_EQ(numberOf(preset.get(), "soil.stiffness_n_m"), 100);
  EXPECT_EQ(hapto_soil_get(preset.get(), "target.cohesion_pa", &number), HAPTO_INVALID_PARAMETER);
}

TEST(LibrarySoil, ItsTextIsTheSameSoil) {
  const SoilPtr soil = soilOf("dry-sand");
  std::string text(10'000, '\0');
  std::uint64_t needed = 0;
  expectOk(hapto_soil_get_toml(soil.get(), text.data(), text.size(), &needed));
  hapto_soil* made = nullptr;
  expectOk(hapto_soil_from_toml(text.c_str(), nullptr, &made));
  const SoilPtr again(made);
  for (const char* key : {"soil.contact_friction", "soil.stiffness_n_m", "target.bulk_density_kg_m3"}) {
    EXPECT_EQ(numberOf(soil.get(), key), numberOf(again.get(), key)) << key;
  }
  EXPECT_EQ(hapto_soil_get_toml(soilOf("P1").get(), text.data(), text.size(), &needed), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_soil_from_toml("name = 3", "mine", &made), HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().message, HasSubstr("mine:1: "));
}

TEST(LibrarySoil, ItsProfileIsATable) {
  const SoilPtr soil = soilOf("P3");
  hapto_result* made = nullptr;
  expectOk(hapto_soil_profile(soil.get(), 1.625, 0.6, &made));
  const ResultPtr profile(made);
  const auto column = [&](const char* name) {
    hapto_array array{};
    array.size = sizeof array;
    expectOk(hapto_result_column(profile.get(), name, &array));
    EXPECT_EQ(array.type, HAPTO_FLOAT64);
    return std::span(static_cast<const double*>(array.data), array.count);
  };
  EXPECT_GE(column("bottom_m").back(), 0.6);
  EXPECT_GT(column("density_kg_m3").back(), column("density_kg_m3").front());
  const char* json = nullptr;
  expectOk(hapto_result_json(profile.get(), &json));
  EXPECT_THAT(json, HasSubstr(R"("columns":["depth_m")"));
  double gravity = 0;
  expectOk(hapto_result_value(profile.get(), "gravity_m_s2", &gravity));
  EXPECT_EQ(gravity, 1.625);
  EXPECT_EQ(hapto_result_value(profile.get(), "soil", &gravity), HAPTO_INVALID_PARAMETER) << "a text";
  EXPECT_EQ(hapto_result_value(profile.get(), "columns.99", &gravity), HAPTO_INVALID_PARAMETER);
  hapto_array array{};
  array.size = sizeof array;
  EXPECT_EQ(hapto_result_column(profile.get(), "depth", &array), HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().valid, HasSubstr("depth_m"));
  EXPECT_EQ(hapto_soil_profile(soil.get(), -1, 0.6, &made), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_soil_profile(soil.get(), 1.625, -1, &made), HAPTO_INVALID_PARAMETER);
}

TEST(LibraryList, NamesWhatThereIs) {
  const auto listed = [](const char* what) {
    hapto_result* made = nullptr;
    expectOk(hapto_list(what, &made));
    const ResultPtr list(made);
    const char* json = nullptr;
    expectOk(hapto_result_json(list.get(), &json));
    return std::string(json);
  };
  EXPECT_THAT(listed("scenes"), HasSubstr("\"regolith\""));
  EXPECT_THAT(listed("soils"), HasSubstr("\"dry-sand\""));
  EXPECT_THAT(listed("presets"), HasSubstr("\"P6\""));
  EXPECT_THAT(listed("bodies"), HasSubstr("\"Moon\""));
  EXPECT_THAT(listed("instruction set"), HasSubstr("\""));
  hapto_result* made = nullptr;
  EXPECT_EQ(hapto_list("planets", &made), HAPTO_INVALID_PARAMETER);
}

}  // namespace
}  // namespace haptolith::library

#include "haptolith/soil/presets.h"

#include <gmock/gmock.h>

#include "haptolith/core/error.h"
#include "haptolith/soil/strength.h"

namespace haptolith {
namespace {

TEST(Presets, AreTableTwo) {
  struct Row {
    const char* name;
    double friction, mu_hat, gamma, rho0, rho_max;
  };
  const Row table[]{
      {"P1", 1.21, 0.494, 3e-5, 1270, 1824},  {"P2", 1.00, 0.409, 3.5e-5, 1300, 1824},
      {"P3", 0.835, 0.342, 4e-5, 1330, 1824}, {"P4", 0.735, 0.300, 6e-5, 1360, 1880},
      {"P5", 0.648, 0.265, 8e-5, 1400, 1920}, {"P6", 0.600, 0.245, 1.2e-4, 1400, 2000},
  };
  ASSERT_EQ(presets().size(), std::size(table));
  for (const Row& row : table) {
    const Preset& preset = findPreset(row.name);
    EXPECT_EQ(preset.friction_coefficient, row.friction);
    EXPECT_EQ(preset.soil.mu_hat, row.mu_hat);
    EXPECT_EQ(preset.soil.gamma_nm, row.gamma);
    EXPECT_EQ(preset.soil.rho0_kg_m3, row.rho0);
    EXPECT_EQ(preset.soil.rho_max_kg_m3, row.rho_max);
    EXPECT_EQ(preset.soil.radius_m, 7e-3);
    EXPECT_EQ(preset.soil.stiffness_n_m, 100);
  }
}

TEST(Presets, HaveTheFrictionThePaperWantsUpToRounding) {
  for (const Preset& preset : presets()) {
    EXPECT_NEAR(frictionCoefficient(preset.soil.mu_hat), preset.friction_coefficient, 0.004) << preset.name;
  }
}

TEST(Presets, AreFoundInLowerCase) {
  EXPECT_EQ(findPreset("p3").name, "P3");
}

TEST(Presets, AnUnknownNameIsRefusedWithTheValidOnes) {
  try {
    static_cast<void>(findPreset("P7"));
    FAIL();
  } catch (const InvalidParameter& error) {
    EXPECT_EQ(error.key(), "preset");
    EXPECT_THAT(error.what(), testing::HasSubstr("P1, P2, P3, P4, P5, P6"));
  }
}

}  // namespace
}  // namespace haptolith

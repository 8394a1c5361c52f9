#include "haptolith/tool/tool_parameters.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

void expectRefused(const std::string& key, const std::function<void(ToolParameters&)>& spoil) {
  ToolParameters tool;
  spoil(tool);
  try {
    validate(tool);
    ADD_FAILURE() << "a wrong " << key << " passed";
  } catch (const InvalidParameter& error) {
    EXPECT_EQ(error.key(), key);
  }
}

TEST(ToolParameters, TheDefaultsAreThePapersShovel) {
  const ToolParameters tool;
  EXPECT_NO_THROW(validate(tool));
  EXPECT_EQ(tool.size_m, Vec3(0.05, 0.04, 0.005));
  EXPECT_EQ(tool.stiffness_n_m, 500);
  EXPECT_EQ(tool.damping_factor, 1.4);
  EXPECT_EQ(tool.adhesion_ratio, 0.002);
}

TEST(ToolParameters, NonsenseIsRefusedByName) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double value : {kNaN, kInfinity, -1.0}) {
    SCOPED_TRACE(value);
    for (int axis = 0; axis < 3; ++axis) {
      expectRefused("size_m", [&](ToolParameters& tool) { tool.size_m[axis] = value; });
    }
    expectRefused("diameter_m", [&](ToolParameters& tool) { tool.diameter_m = value; });
    expectRefused("thickness_m", [&](ToolParameters& tool) { tool.thickness_m = value; });
    expectRefused("opening_m", [&](ToolParameters& tool) { tool.opening_m = value; });
    expectRefused("stiffness_n_m", [&](ToolParameters& tool) { tool.stiffness_n_m = value; });
    expectRefused("damping_factor", [&](ToolParameters& tool) { tool.damping_factor = value; });
    expectRefused("adhesion_ratio", [&](ToolParameters& tool) { tool.adhesion_ratio = value; });
  }
  expectRefused("size_m", [](ToolParameters& tool) { tool.size_m.y() = 0; });
  expectRefused("diameter_m", [](ToolParameters& tool) { tool.diameter_m = 0; });
  expectRefused("thickness_m", [](ToolParameters& tool) { tool.thickness_m = 0; });
}

}  // namespace
}  // namespace haptolith

#include "haptolith/device/hand/hand_parameters.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

void expectRefused(const std::string& key, const std::function<void(HandParameters&)>& spoil) {
  HandParameters hand;
  spoil(hand);
  try {
    validate(hand);
    ADD_FAILURE() << "a wrong " << key << " passed";
  } catch (const InvalidParameter& error) {
    EXPECT_EQ(error.key(), key);
  }
}

TEST(HandParameters, NonsenseIsRefusedByName) {
  EXPECT_NO_THROW(validate(HandParameters{}));
  using Member = double HandParameters::*;
  const std::pair<const char*, Member> members[] = {{"mass_kg", &HandParameters::mass_kg},
                                                    {"damping_n_s_m", &HandParameters::damping_n_s_m},
                                                    {"stiffness_n_m", &HandParameters::stiffness_n_m},
                                                    {"lever_m", &HandParameters::lever_m},
                                                    {"period_s", &HandParameters::period_s},
                                                    {"active_s", &HandParameters::active_s},
                                                    {"depth_m", &HandParameters::depth_m},
                                                    {"reach_m", &HandParameters::reach_m},
                                                    {"max_force_n", &HandParameters::max_force_n},
                                                    {"max_torque_nm", &HandParameters::max_torque_nm}};
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.0}) {
    SCOPED_TRACE(value);
    for (const auto& [key, member] : members) {
      expectRefused(key, [&, m = member](HandParameters& hand) { hand.*m = value; });
    }
  }
  expectRefused("mass_kg", [](HandParameters& hand) { hand.mass_kg = 0; });
  expectRefused("period_s", [](HandParameters& hand) { hand.period_s = 0; });
  expectRefused("lever_m", [](HandParameters& hand) { hand.lever_m = 0; });
  for (int axis = 0; axis < 3; ++axis) {
    expectRefused("home_m",
                  [&](HandParameters& hand) { hand.home_m[axis] = std::numeric_limits<double>::quiet_NaN(); });
  }
  expectRefused("surface_m", [](HandParameters& hand) { hand.surface_m = 11; });
  expectRefused("poses", [](HandParameters& hand) { hand.motion = HandMotion::kPoses; });
}

}  // namespace
}  // namespace haptolith

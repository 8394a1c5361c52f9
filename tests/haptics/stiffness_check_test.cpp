#include "haptolith/haptics/loop/stiffness_check.h"

#include <gmock/gmock.h>

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kRadius_m = 0.005;
constexpr double kTick_s = 1e-3;

/// A sphere 60 mm across, of 500 N/m: pi 30^2 / (4 * 5^2) = 28.27, so 29 contacts.
ToolParameters sphere() {
  ToolParameters tool;
  tool.shape = ToolShape::kSphere;
  tool.diameter_m = 0.06;
  tool.stiffness_n_m = 500;
  return tool;
}

HandlingParameters joined(CouplingKind kind) {
  HandlingParameters handling;
  handling.coupling.kind = kind;
  handling.coupling.spring = {.mass_kg = 0.3, .damping_n_s_m = 19, .stiffness_n_m = 300, .lever_m = 0.1};
  return handling;
}

DeviceLimits damped(double damping_n_s_m, bool shows_force = true) {
  DeviceLimits limits;
  limits.damping_n_s_m = damping_n_s_m;
  limits.shows_force = shows_force;
  return limits;
}

TEST(StiffnessCheck, DirectlyCoupledAllContactsAtOnceNeedHalfATicksDamping) {
  const StiffnessCheck check =
      checkStiffness(joined(CouplingKind::kDirect), sphere(), kRadius_m, damped(7.26), kTick_s);
  EXPECT_DOUBLE_EQ(check.stiffness_n_m, 14'500);
  EXPECT_DOUBLE_EQ(check.needed_n_s_m, 7.25);
  EXPECT_EQ(check.declared_n_s_m, 7.26);
  EXPECT_TRUE(check.stable());
  EXPECT_FALSE(checkStiffness(joined(CouplingKind::kDirect), sphere(), kRadius_m, damped(7.24), kTick_s).stable());
}

TEST(StiffnessCheck, TheShovelsContactsAreThoseOnTheCircleAroundIt) {
  // sqrt(50^2 + 40^2 + 5^2) / 2 = 32.11 mm; pi 32.11^2 / (4 * 5^2) = 32.4, so 33 contacts of 500 N/m.
  const StiffnessCheck check = checkStiffness(joined(CouplingKind::kDirect), {}, kRadius_m, damped(0), kTick_s);
  EXPECT_DOUBLE_EQ(check.stiffness_n_m, 16'500);
}

TEST(StiffnessCheck, VirtuallyCoupledTheSpringAndItsDamperCountWhateverTheSoil) {
  HandlingParameters handling = joined(CouplingKind::kVirtual);
  handling.coupling.spring.stiffness_n_m = 300;
  handling.coupling.spring.damping_n_s_m = 19;
  const StiffnessCheck check = checkStiffness(handling, sphere(), kRadius_m, damped(19.16), kTick_s);
  EXPECT_DOUBLE_EQ(check.stiffness_n_m, 300);
  EXPECT_DOUBLE_EQ(check.needed_n_s_m, 19.15);  // 300 * 0.001 / 2 + 19
  EXPECT_TRUE(check.stable());
  EXPECT_FALSE(checkStiffness(handling, sphere(), kRadius_m, damped(19.15), kTick_s).stable());  // b > , not >=
}

TEST(StiffnessCheck, BothScalesMakeItStifferAtTheDevice) {
  // A displacement is `scale` larger in the scene, and its force `force_scale` larger at the hand.
  HandlingParameters handling = joined(CouplingKind::kDirect);
  handling.mapping.scale = 2;
  handling.mapping.force_scale = 0.25;
  EXPECT_DOUBLE_EQ(checkStiffness(handling, sphere(), kRadius_m, {}, kTick_s).stiffness_n_m, 7250);
  handling.coupling.kind = CouplingKind::kVirtual;
  const StiffnessCheck check = checkStiffness(handling, sphere(), kRadius_m, {}, kTick_s);
  EXPECT_DOUBLE_EQ(check.stiffness_n_m, 150);
  EXPECT_DOUBLE_EQ(check.needed_n_s_m, 0.5 * 19.15);
}

TEST(StiffnessCheck, LeftToItselfTheCouplingFollowsFromTheDevice) {
  const HandlingParameters handling = joined(CouplingKind::kAuto);
  EXPECT_EQ(checkStiffness(handling, sphere(), kRadius_m, damped(1, true), kTick_s).stiffness_n_m, 14'500);
  EXPECT_EQ(checkStiffness(handling, sphere(), kRadius_m, damped(1, false), kTick_s).stiffness_n_m, 300);
}

TEST(StiffnessCheck, ItsTextHasTheNumbersAndWhatHelps) {
  EXPECT_THAT(checkStiffness(joined(CouplingKind::kDirect), sphere(), kRadius_m, damped(2.5), kTick_s).text,
              AllOf(HasSubstr("14500 N/m"), HasSubstr("29 simultaneous contacts of 500 N/m"), HasSubstr("7.2 N s/m"),
                    HasSubstr("the device has 2.5"), HasSubstr("force_scale"), HasSubstr("kind = \"virtual\"")));
  EXPECT_THAT(checkStiffness(joined(CouplingKind::kVirtual), sphere(), kRadius_m, damped(2.5), kTick_s).text,
              AllOf(HasSubstr("300 N/m"), HasSubstr("virtual coupling"), HasSubstr("19 N s/m"),
                    HasSubstr("A softer [coupling]"), Not(HasSubstr("contacts"))));
}

}  // namespace
}  // namespace haptolith

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "use.h"

namespace haptolith::library {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

using SafetyPtr = std::unique_ptr<hapto_safety, Destroy>;

hapto_device_limits limitsOf(double most_n) {
  hapto_device_limits limits{};
  expectOk(hapto_device_limits_init(&limits));
  limits.max_force_n = most_n;
  return limits;
}

SafetyPtr safetyOf(const hapto_device_limits& limits, std::vector<const char*> overrides = {}) {
  hapto_safety* safety = nullptr;
  expectOk(
      hapto_safety_create(&limits, overrides.data(), static_cast<std::uint32_t>(overrides.size()), 1e-3, 100, &safety));
  return SafetyPtr(safety);
}

/// Permitted part of a force for a hand at rest.
double shown(hapto_safety* safety, double force_n, double z_m = 0) {
  hapto_device_input told{};
  told.size = sizeof told;
  told.pose = {{0, 0, z_m}, {1, 0, 0, 0}};
  hapto_device_output force{};
  force.size = sizeof force;
  force.wrench.force_n[2] = force_n;
  EXPECT_EQ(hapto_safety_step(safety, &told, 0, &force), HAPTO_OK);
  return force.wrench.force_n[2];
}

hapto_safety_info infoOf(const hapto_safety* safety) {
  hapto_safety_info info{};
  info.size = sizeof info;
  EXPECT_EQ(hapto_safety_get_info(safety, &info), HAPTO_OK);
  return info;
}

TEST(LibrarySafety, StartsSoftlyAndKeepsTheDevicesLimit) {
  const SafetyPtr safety = safetyOf(limitsOf(5));
  EXPECT_LT(shown(safety.get(), 100), 0.1);
  double felt = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    felt = shown(safety.get(), 100);
  }
  EXPECT_NEAR(felt, 5, 1e-9);
  EXPECT_NE(infoOf(safety.get()).flags & HAPTO_SAFETY_SATURATED, 0U);
  expectOk(hapto_safety_stop(safety.get()));
  for (int tick = 0; tick < 400; ++tick) {
    felt = shown(safety.get(), 100);
  }
  EXPECT_EQ(felt, 0);
}

TEST(LibrarySafety, LetsGoOfAHandThatCannotBe) {
  const SafetyPtr safety = safetyOf(limitsOf(kInfinite), {"safety.soft_start_s=0.01"});
  for (int tick = 0; tick < 100; ++tick) {
    (void)shown(safety.get(), 1);
  }
  EXPECT_NEAR(shown(safety.get(), 1), 1, 1e-6);
  EXPECT_EQ(shown(safety.get(), 1, 0.05), 0) << "5 cm in a millisecond";
  EXPECT_STRNE(infoOf(safety.get()).trip, "");
  EXPECT_EQ(infoOf(safety.get()).trips, 1U);
  EXPECT_EQ(shown(safety.get(), std::numeric_limits<double>::quiet_NaN(), 0.05), 0);
}

TEST(LibrarySafety, RefusesWhatIsNotIts) {
  const hapto_device_limits limits = limitsOf(1);
  hapto_safety* safety = nullptr;
  const auto made = [&](const char* override, double tick_s, double stiffness_n_m) {
    return hapto_safety_create(&limits, &override, 1, tick_s, stiffness_n_m, &safety);
  };
  EXPECT_EQ(made("bed.threads=2", 1e-3, 100), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(made("safety.recovery_s=-1", 1e-3, 100), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().key, "safety.recovery_s");
  EXPECT_EQ(made("safety.recovery_s=1", 1, 100), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(made("safety.recovery_s=1", 1e-3, -5), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(safety, nullptr);
}

}  // namespace
}  // namespace haptolith::library

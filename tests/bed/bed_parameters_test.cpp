#include "haptolith/bed/bed_parameters.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <string>

#include "haptolith/bed/bed.h"
#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void expectRefused(const std::string& key, const std::function<void(BedParameters&)>& spoil) {
  BedParameters bed;
  spoil(bed);
  try {
    validate(bed);
    ADD_FAILURE() << "a wrong " << key << " passed";
  } catch (const InvalidParameter& error) {
    EXPECT_EQ(error.key(), key);
    EXPECT_THAT(error.what(), testing::HasSubstr("must be"));
  }
  // The bed itself refuses the same, also when it is given its centres.
  EXPECT_THROW(Bed{bed}, InvalidParameter) << key;
  EXPECT_THROW((Bed{bed, {Vec3(0, 0, 0.01)}}), InvalidParameter) << key;
}

TEST(BedParameters, TheDefaultsAreThePapersScene) {
  const BedParameters bed;
  EXPECT_NO_THROW(validate(bed));
  EXPECT_EQ(bed.particles, 256);
  EXPECT_EQ(bed.layers, 3);
  EXPECT_EQ(bed.width_m, 0.126);
  EXPECT_EQ(bed.length_m, 0.126);
  EXPECT_EQ(bed.gravity_m_s2, Vec3(0, 0, -1.625));
}

TEST(BedParameters, NonsenseIsRefusedByName) {
  for (const double value : {kNaN, kInfinity, -1.0, 0.0, 1e5}) {
    SCOPED_TRACE(value);
    expectRefused("width_m", [&](BedParameters& bed) { bed.width_m = value; });
    expectRefused("length_m", [&](BedParameters& bed) { bed.length_m = value; });
    expectRefused("tick_s", [&](BedParameters& bed) { bed.tick_s = value; });
    expectRefused("depth_m", [&](BedParameters& bed) {
      bed.start = BedStart::kPacked;
      bed.depth_m = value;
    });
  }
  for (const double value : {kNaN, kInfinity, 1001.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      expectRefused("gravity_m_s2", [&](BedParameters& bed) { bed.gravity_m_s2[axis] = value; });
    }
  }
  for (const int value : {0, -1, std::numeric_limits<int>::min()}) {
    expectRefused("particles", [&](BedParameters& bed) { bed.particles = value; });
    expectRefused("layers", [&](BedParameters& bed) { bed.layers = value; });
    expectRefused("threads", [&](BedParameters& bed) { bed.threads = value; });
    expectRefused("max_substeps", [&](BedParameters& bed) { bed.max_substeps = value; });
  }
  expectRefused("threads", [](BedParameters& bed) { bed.threads = 257; });
}

TEST(BedParameters, WrongSoilIsRefusedByName) {
  for (const double value : {kNaN, 0.0, -1.0, kInfinity}) {
    SCOPED_TRACE(value);
    expectRefused("radius_m", [&](BedParameters& bed) { bed.soil.radius_m = value; });
    expectRefused("gamma_nm", [&](BedParameters& bed) { bed.soil.gamma_nm = value; });
    expectRefused("rho0_kg_m3", [&](BedParameters& bed) { bed.soil.rho0_kg_m3 = value; });
    expectRefused("stiffness_n_m", [&](BedParameters& bed) { bed.soil.stiffness_n_m = value; });
    expectRefused("attraction_ratio", [&](BedParameters& bed) { bed.soil.attraction_ratio = value; });
  }
  expectRefused("attraction_ratio", [](BedParameters& bed) { bed.soil.attraction_ratio = 0.999; });
  expectRefused("rho_max_kg_m3", [](BedParameters& bed) { bed.soil.rho_max_kg_m3 = bed.soil.rho0_kg_m3; });
  expectRefused("mu_hat", [](BedParameters& bed) { bed.soil.mu_hat = -0.1; });
  expectRefused("moving_friction_ratio", [](BedParameters& bed) { bed.soil.moving_friction_ratio = 1.1; });
}

TEST(BedParameters, AGammaThatTheTickDoesNotResolveIsRefused) {
  for (const double gamma_nm : {1e-12, 1e-20, 1e-323}) {
    expectRefused("gamma_nm", [&](BedParameters& bed) { bed.soil.gamma_nm = gamma_nm; });
  }
}

TEST(BedParameters, ABoxNarrowerThanAParticleIsRefused) {
  expectRefused("width_m", [](BedParameters& bed) { bed.width_m = 1.99 * bed.soil.radius_m; });
  BedParameters narrow;
  narrow.width_m = narrow.length_m = 2 * narrow.soil.radius_m;
  EXPECT_NO_THROW(validate(narrow));
}

TEST(BedParameters, CentresThatAreNoNumbersAreRefused) {
  EXPECT_THROW((Bed{BedParameters{}, {Vec3(0, 0, 0.01), Vec3(0, kNaN, 0.02)}}), InvalidParameter);
  EXPECT_THROW((Bed{BedParameters{}, {Vec3(kInfinity, 0, 0.01)}}), InvalidParameter);
  EXPECT_THROW((Bed{BedParameters{}, {Vec3(0, 0, 1e300)}}), InvalidParameter);  // infinite as a float
}

}  // namespace
}  // namespace haptolith

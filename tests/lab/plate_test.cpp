#include "haptolith/lab/tests/plate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "haptolith/core/error.h"

#include "small_soil.h"

namespace haptolith {
namespace {

const PlateOptions kSmall{.diameter_m = 0.06,
                          .max_sinkage_m = 0.016,
                          .speed_m_s = 0.04,
                          .bed_width_diameters = 2.5,
                          .bed_depth_diameters = 1.2,
                          .window_m = 2e-3,
                          .points = 32};

double force(const PlateResult& plate, double sinkage_m) {
  return forceAt(plate.curve, sinkage_m);
}

TEST(Plate, MeetsMoreAndMoreResistanceFromItsFirstContactOn) {
  const PlateResult plate = plateTest(coarseSand(7e-3), kSmall);
  ASSERT_EQ(plate.curve.size(), 33U);
  EXPECT_EQ(plate.curve.front().depth_m, 0);
  EXPECT_NEAR(plate.curve.back().depth_m, 0.016, 1e-12);
  EXPECT_NEAR(plate.area_m2, std::numbers::pi * 9e-4, 1e-9);
  // Contact is 5 % of rho0 g D A = 0.11 N; the mean about it is of that order.
  EXPECT_LT(std::abs(force(plate, 0)), 1);
  EXPECT_GT(force(plate, 0.005), 1);
  EXPECT_GT(force(plate, 0.010), 1.2 * force(plate, 0.005));
  EXPECT_GT(force(plate, 0.015), 1.2 * force(plate, 0.010));
}

TEST(Plate, HasMetTheTipsOfGrainsWhereItReachesTheSurface) {
  PlateOptions options = kSmall;
  const PlateResult from_contact = plateTest(coarseSand(7e-3), options);
  options.depth_from = DepthFrom::kSurface;
  const PlateResult from_surface = plateTest(coarseSand(7e-3), options);
  EXPECT_GT(force(from_surface, 0), force(from_contact, 0));
  EXPECT_LT(from_surface.bed_depth_m, from_contact.bed_depth_m - 0.4 * 7e-3);
  EXPECT_GT(force(from_surface, 0.005), force(from_contact, 0.005));
}

TEST(Plate, IsCarriedByItsFitAndByASoilOfTheRightDensity) {
  const PlateResult plate = plateTest(coarseSand(7e-3), kSmall);
  EXPECT_GT(plate.fit.exponent, 0.4);
  EXPECT_LT(plate.fit.exponent, 3);
  const double fitted = plate.fit.pressureAt(0.012) * plate.area_m2;
  EXPECT_NEAR(fitted / force(plate, 0.012), 1, 0.3);
  // Particles weigh as if they filled pi/sqrt(18) = 0.74 of the room with rho0 = 1330; at random they fill 0.55 to
  // 0.66.
  EXPECT_GT(plate.bulk_density_kg_m3, 1330 * 0.52 / 0.74);
  EXPECT_LT(plate.bulk_density_kg_m3, 1330 * 0.70 / 0.74);
  EXPECT_EQ(plate.trace.columns.size(), 3U);
  ASSERT_EQ(plate.trace.rows.size(), plate.curve.size());
  EXPECT_EQ(plate.trace.rows[20][1], plate.curve[20].force_n);
}

TEST(Plate, NeedsForceInProportionToGravityWhenContactsAreAsMuchSofter) {
  // That soil in other units of time: only the settling of the bed differs. With stiff contacts on both
  // bodies the ratio is less, for soil that is pressed together less dilates more.
  constexpr double kWeaker = 4;
  const double strong = force(plateTest(coarseSand(7e-3), kSmall), 0.015);
  LabConditions conditions = coarseSand(7e-3);
  conditions.gravity_m_s2 /= kWeaker;
  conditions.soil.stiffness_n_m /= kWeaker;
  conditions.soil.gamma_nm /= kWeaker;
  PlateOptions slower = kSmall;
  *slower.speed_m_s /= std::sqrt(kWeaker);
  EXPECT_NEAR(strong / force(plateTest(conditions, slower), 0.015) / kWeaker, 1, 0.35);
}

TEST(Plate, SinksDeeperIntoLooseSoilOnDenseSoil) {
  PlateOptions layered = kSmall;
  layered.loose_top_m = 0.03;
  const PlateResult dense = plateTest(coarseSand(7e-3), kSmall);
  const PlateResult plate = plateTest(coarseSand(7e-3), layered);
  EXPECT_NEAR(static_cast<double>(plate.particles), static_cast<double>(dense.particles), 2);
  EXPECT_GT(plate.bed_depth_m, dense.bed_depth_m);
  EXPECT_LT(force(plate, 0.005), 0.7 * force(dense, 0.005));
  EXPECT_LT(force(plate, 0.015), force(dense, 0.015));
}

TEST(Plate, TestGivesTheSameAgain) {
  const PlateResult once = plateTest(coarseSand(7e-3), kSmall);
  LabConditions conditions = coarseSand(7e-3);
  conditions.threads = 2;
  const PlateResult again = plateTest(conditions, kSmall);
  for (std::size_t i = 0; i < once.curve.size(); ++i) {
    EXPECT_EQ(once.curve[i].force_n, again.curve[i].force_n);
  }
}

TEST(Plate, TestTellsItsProgressAndGivesUpWhenTold) {
  LabConditions conditions = coarseSand(7e-3);
  std::vector<std::string> told;
  conditions.progress = [&](std::string_view what, double share) {
    EXPECT_GE(share, 0);
    EXPECT_LE(share, 1);
    told.emplace_back(what);
    return what != "the plate sinks in";
  };
  EXPECT_THROW(static_cast<void>(plateTest(conditions, kSmall)), Failure);
  EXPECT_GT(told.size(), 1U);
  EXPECT_EQ(told.back(), "the plate sinks in");
}

TEST(Plate, TestRefusesNonsense) {
  const std::vector<std::function<void(PlateOptions&)>> nonsense = {
      [](PlateOptions& plate) { plate.diameter_m = 0.05; },  // under 4 particles
      [](PlateOptions& plate) { plate.max_sinkage_m = 0; },
      [](PlateOptions& plate) { plate.max_sinkage_m = 0.5; },
      [](PlateOptions& plate) { plate.speed_m_s = -0.01; },
      [](PlateOptions& plate) { plate.friction = std::nan(""); },
      [](PlateOptions& plate) { plate.bed_width_diameters = 1.5; },
      [](PlateOptions& plate) { plate.bed_depth_diameters = 0.1; },  // through the floor
      [](PlateOptions& plate) { plate.loose_top_m = -0.01; },
      [](PlateOptions& plate) { plate.loose_top_m = 0.06; },  // nothing below it
      [](PlateOptions& plate) { plate.window_m = 0; },
      [](PlateOptions& plate) { plate.points = 2; },
  };
  for (std::size_t i = 0; i < nonsense.size(); ++i) {
    PlateOptions options = kSmall;
    nonsense[i](options);
    EXPECT_THROW(static_cast<void>(plateTest(coarseSand(7e-3), options)), InvalidParameter) << i;
  }
  LabConditions weightless = coarseSand(7e-3);
  weightless.gravity_m_s2 = 0;
  EXPECT_THROW(static_cast<void>(plateTest(weightless, kSmall)), InvalidParameter);
}

TEST(Plate, ForceBetweenReadingsIsOnTheLineBetweenThem) {
  const std::vector<PushReading> readings{{0, 0}, {0.002, 4}, {0.004, 6}};
  EXPECT_EQ(forceAt(readings, 0), 0);
  EXPECT_EQ(forceAt(readings, 0.002), 4);
  EXPECT_DOUBLE_EQ(forceAt(readings, 0.0005), 1);
  EXPECT_DOUBLE_EQ(forceAt(readings, 0.003), 5);
  EXPECT_THROW(static_cast<void>(forceAt(readings, 0.005)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(forceAt({}, 0)), InvalidParameter);
}

TEST(Plate, IsDrawnBesideWhatWasMeasured) {
  PlateResult plate;
  plate.curve = {{0, 0}, {0.01, 10}, {0.02, 25}};
  plate.area_m2 = 0.0028;
  plate.fit = {.modulus = 1e6, .exponent = 1.2};
  const auto file = std::filesystem::path(testing::TempDir()) / "plate.svg";
  std::filesystem::remove(file);  // left by an earlier run
  drawPlate(file, plate, "a soil", {{"run 1", {{0, 0}, {0.01, 11}}}});
  std::ifstream stream(file);
  const std::string svg{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_NE(svg.find("run 1"), std::string::npos);
  EXPECT_NE(svg.find("n = 1.20"), std::string::npos);
}

}  // namespace
}  // namespace haptolith

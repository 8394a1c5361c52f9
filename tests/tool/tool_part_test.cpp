#include "haptolith/tool/tool_part.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "haptolith/tool/tool_mesh.h"

namespace haptolith {
namespace {

constexpr double kReach_m = 0.012;

std::shared_ptr<const ToolMesh> made(const std::vector<ToolPart>& parts) {
  return toolMesh({.name = "parts",
                   .bytes = std::make_shared<const std::string>(drawn(parts)),
                   .format = MeshFormat::kObj,
                   .origin_m = Vec3::Zero()},
                  kReach_m);
}

/// Volume of a closed surface whose triangles are counter-clockwise seen from outside.
double volumeOf(const TriangleMesh& mesh) {
  double six_m3 = 0;
  for (const auto& triangle : mesh.triangles) {
    const auto [a, b, c] = cornersOf(mesh, triangle);
    six_m3 += a.dot(b.cross(c));
  }
  return six_m3 / 6;
}

TEST(ToolPart, HasTheVolumeOfItsShape) {
  const auto volume_m3 = [](const ToolPart& part) { return volumeOf(made({part})->surface); };
  EXPECT_NEAR(volume_m3({.size_m = Vec3(0.05, 0.04, 0.01)}), 2e-5, 1e-9);
  const double ball_m3 = 4.0 / 3 * std::numbers::pi * std::pow(0.015, 3);
  EXPECT_NEAR(volume_m3({.form = ToolPartForm::kSphere, .diameter_m = 0.03}), ball_m3, 0.005 * ball_m3);
  const double tube_m3 = std::numbers::pi * std::pow(0.01, 2) * 0.05;
  EXPECT_NEAR(volume_m3({.form = ToolPartForm::kCylinder, .diameter_m = 0.02, .length_m = 0.05}), tube_m3,
              0.002 * tube_m3);
}

TEST(ToolPart, NeedsNoMending) {
  for (const ToolPartForm form : {ToolPartForm::kBox, ToolPartForm::kSphere, ToolPartForm::kCylinder}) {
    EXPECT_TRUE(made({{.form = form}})->report.empty()) << made({{.form = form}})->report.front();
  }
}

TEST(ToolPart, IsAsFarAwayAsItsShapeWhereItStandsAndIsTurned) {
  const Vec3 half_m(0.02, 0.01, 0.005);
  const Vec3 at_m(0.01, -0.02, 0.03);
  const double angle = 0.5;
  const auto mesh = made({{.size_m = 2 * half_m, .at_m = at_m, .turn_rad = Vec3(0, 0, angle)}});
  const auto distance_m = [&](const Vec3& in_box_m) {
    const Vec3 from_m(std::cos(angle) * in_box_m.x() - std::sin(angle) * in_box_m.y(),
                      std::sin(angle) * in_box_m.x() + std::cos(angle) * in_box_m.y(), in_box_m.z());
    return mesh->field.at(at_m + from_m).distance_m;
  };
  EXPECT_NEAR(distance_m(Vec3(0.026, 0, 0)), 0.006, 5e-5);
  EXPECT_NEAR(distance_m(Vec3(0, 0.015, 0)), 0.005, 5e-5);
  EXPECT_NEAR(distance_m(Vec3(0, 0, -0.010)), 0.005, 5e-5);
  EXPECT_NEAR(distance_m(Vec3(0.023, 0.014, 0)), 0.005, 1e-4);
  EXPECT_NEAR(distance_m(Vec3(0, 0, 0.003)), -0.002, 5e-5);
}

TEST(ToolPart, TogetherAreSolidWhereAnyOfThemIs) {
  const auto mesh =
      made({{.size_m = Vec3(0.005, 0.06, 0.03)},
            {.form = ToolPartForm::kCylinder, .diameter_m = 0.012, .length_m = 0.08, .at_m = Vec3(0, 0, 0.05)}});
  EXPECT_LT(mesh->field.at(Vec3(0, 0.02, 0)).distance_m, 0);
  EXPECT_LT(mesh->field.at(Vec3(0, 0, 0.012)).distance_m, 0);  // in both
  EXPECT_LT(mesh->field.at(Vec3(0, 0, 0.08)).distance_m, 0);
  EXPECT_NEAR(mesh->field.at(Vec3(0.012, 0, 0.07)).distance_m, 0.006, 1e-4);
  EXPECT_GT(mesh->field.at(Vec3(0, 0.02, 0.03)).distance_m, 0);
}

TEST(ToolPart, RefusesWhatCannotBe) {
  EXPECT_THROW(validate(ToolPart{.size_m = Vec3(0.05, 0.04, 0)}), InvalidParameter);
  EXPECT_THROW(validate(ToolPart{.form = ToolPartForm::kSphere, .diameter_m = NAN}), InvalidParameter);
  EXPECT_THROW(validate(ToolPart{.form = ToolPartForm::kCylinder, .length_m = 2}), InvalidParameter);
  EXPECT_THROW(validate(ToolPart{.at_m = Vec3(0, 5, 0)}), InvalidParameter);
  EXPECT_THROW((void)drawn(std::vector<ToolPart>(65)), InvalidParameter);
  EXPECT_THROW((void)drawn(std::vector<ToolPart>{{.turn_rad = Vec3(10, 0, 0)}}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith

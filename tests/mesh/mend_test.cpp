#include "haptolith/mesh/mend.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "haptolith/core/error.h"

#include "made_meshes.h"

namespace haptolith {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kCube_m3 = 0.02 * 0.02 * 0.02;

/// Each edge is passed as often in one direction as in the other.
bool isClosed(const TriangleMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t from = t[i];
      const std::int32_t to = t[(i + 1) % 3];
      edges[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
    }
  }
  return std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 0; });
}

std::string refusalOf(const TriangleMesh& mesh, const MendOptions& options = {}) {
  try {
    (void)mend(mesh, options);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Mend, LeavesASoundSolidAlone) {
  const MendedMesh mended = mend(made::cube(0.02));
  EXPECT_EQ(mended.mesh.points_m.size(), 8U);
  EXPECT_EQ(mended.mesh.triangles.size(), 12U);
  EXPECT_TRUE(isClosed(mended.mesh));
  EXPECT_NEAR(made::volume_m3(mended.mesh), kCube_m3, 1e-15);
  EXPECT_EQ(mended.shell_count, 1);
  EXPECT_EQ(mended.sheet_thickness_m, 0);
  EXPECT_THAT(mended.report, IsEmpty());
}

TEST(Mend, TurnsASolidOutwards) {
  const MendedMesh mended = mend(made::insideOut(made::cube(0.02)));
  EXPECT_NEAR(made::volume_m3(mended.mesh), kCube_m3, 1e-15);
  EXPECT_THAT(mended.report, ElementsAre("Flipped 1 part (inside out)."));
}

TEST(Mend, TurnsTrianglesAsTheirNeighboursLook) {
  TriangleMesh mesh = made::sphere(0.02, 12);
  const double volume_m3 = made::volume_m3(mesh);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    std::swap(mesh.triangles[i][0], mesh.triangles[i][1]);
  }
  const MendedMesh mended = mend(mesh);
  EXPECT_TRUE(isClosed(mended.mesh));
  EXPECT_NEAR(made::volume_m3(mended.mesh), volume_m3, 1e-15);
  EXPECT_THAT(mended.report, testing::Contains(HasSubstr("reversed orientation")));
}

TEST(Mend, LeavesOutCopiesAndTrianglesWithoutArea) {
  TriangleMesh mesh = made::together(made::cube(0.02), made::cube(0.02));
  made::addTriangle(mesh, Vec3(0.01, 0.01, 0.01), Vec3(0.01, 0.01, 0.01), Vec3(-0.01, 0.01, 0.01));
  const MendedMesh mended = mend(mesh);
  EXPECT_EQ(mended.mesh.triangles.size(), 12U);
  EXPECT_NEAR(made::volume_m3(mended.mesh), kCube_m3, 1e-15);
  EXPECT_THAT(mended.report, ElementsAre("Removed 1 triangle without area.", "Removed 12 copies of triangles."));
}

TEST(Mend, TakesASurfaceDrawnFromBothSidesForOne) {
  const MendedMesh mended = mend(made::together(made::cube(0.02), made::insideOut(made::cube(0.02))));
  EXPECT_EQ(mended.mesh.triangles.size(), 12U);
  EXPECT_NEAR(made::volume_m3(mended.mesh), kCube_m3, 1e-15);
}

TEST(Mend, TakesTheWallBetweenPartsThatTouchAway) {
  const TriangleMesh left = made::cube(0.02, Vec3(-0.01, 0, 0));
  TriangleMesh right = made::cube(0.02, Vec3(-0.01, 0, 0));
  for (Vec3& point_m : right.points_m) {
    point_m.x() = -point_m.x();  // so that the faces between have the same triangles
  }
  const MendedMesh mended = mend(made::together(left, made::insideOut(right)));
  EXPECT_EQ(mended.mesh.triangles.size(), 20U);
  EXPECT_TRUE(isClosed(mended.mesh));
  EXPECT_NEAR(made::volume_m3(mended.mesh), 2 * kCube_m3, 1e-15);
  EXPECT_THAT(mended.report, ElementsAre(HasSubstr("2 wall triangles inside")));
}

TEST(Mend, LeavesTinyLoosePartsOut) {
  const MendedMesh mended = mend(made::together(made::cube(0.1), made::cube(0.0005, Vec3(0.08, 0, 0))));
  EXPECT_EQ(mended.mesh.triangles.size(), 12U);
  EXPECT_THAT(mended.report, ElementsAre(HasSubstr("1 loose part")));
  EXPECT_EQ(mend(made::together(made::cube(0.1), made::cube(0.005, Vec3(0.08, 0, 0)))).mesh.triangles.size(), 24U);
}

TEST(Mend, ClosesSmallHoles) {
  TriangleMesh mesh = made::sphere(0.05, 40);
  const double volume_m3 = made::volume_m3(mesh);
  const std::size_t all = mesh.triangles.size();
  mesh.triangles.erase(mesh.triangles.begin() + 1000, mesh.triangles.begin() + 1004);  // four in a row
  mesh.triangles.erase(mesh.triangles.begin() + 2000);                                 // and one
  const MendedMesh mended = mend(mesh);
  EXPECT_TRUE(isClosed(mended.mesh));
  EXPECT_EQ(mended.mesh.triangles.size(), all - 5 + 1 + 6 - 80 * 2) << "a fan of six, less the poles' without area";
  EXPECT_NEAR(made::volume_m3(mended.mesh), volume_m3, 1e-3 * volume_m3);
  EXPECT_THAT(mended.report, testing::Contains(HasSubstr("Closed 2 openings")));
}

TEST(Mend, ClosesSlitsOfAnyLengthAndJoinsWhatNearlyMeets) {
  // One edge of a face has a point more than the edge of its neighbour.
  TriangleMesh mesh = made::cube(0.02);
  mesh.triangles.pop_back();  // (1,0,0), (1,1,1), (1,0,1)
  const Vec3 a(0.01, -0.01, -0.01);
  const Vec3 b(0.01, 0.01, 0.01);
  const Vec3 c(0.01, -0.01, 0.01);
  made::addTriangle(mesh, a, b, (a + c) / 2);
  made::addTriangle(mesh, b, c + Vec3::Constant(1e-8), (a + c) / 2);
  const MendedMesh mended = mend(mesh);
  EXPECT_TRUE(isClosed(mended.mesh));
  EXPECT_NEAR(made::volume_m3(mended.mesh), kCube_m3, 1e-12);
  EXPECT_THAT(mended.report, testing::Contains(HasSubstr("Joined 1 point")));
  EXPECT_THAT(mended.report, testing::Contains(HasSubstr("Closed 1 opening")));
}

TEST(Mend, RefusesWhatStaysOpenAndMakesASheetOfIt) {
  TriangleMesh mesh = made::cube(0.02);
  mesh.triangles.resize(10);  // without a face
  EXPECT_THAT(refusalOf(mesh), AllOf(HasSubstr("open in 1 place"), HasSubstr("80 mm around"), HasSubstr("sheet")));
  const MendedMesh mended = mend(mesh, {.sheet_thickness_m = 0.002});
  EXPECT_EQ(mended.sheet_thickness_m, 0.002);
  EXPECT_EQ(mended.mesh.triangles.size(), 10U);
  EXPECT_THAT(mended.report, ElementsAre("The surface is open: a sheet 2 mm thick."));
}

TEST(Mend, ASheetKeepsItsHoles) {
  TriangleMesh mesh = made::sphere(0.05, 40);
  mesh.triangles.erase(mesh.triangles.begin() + 1000);
  EXPECT_EQ(mend(mesh).sheet_thickness_m, 0);
  EXPECT_EQ(mend(mesh, {.sheet_thickness_m = 0.001}).sheet_thickness_m, 0.001);
  EXPECT_EQ(mend(made::cube(0.02), {.sheet_thickness_m = 0.001}).sheet_thickness_m, 0) << "closed: solid";
}

TEST(Mend, RefusesNothingAndASingleTriangle) {
  EXPECT_THAT(refusalOf({}), HasSubstr("nothing with an area"));
  TriangleMesh point;
  made::addTriangle(point, Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
  EXPECT_THAT(refusalOf(point), HasSubstr("nothing with an area"));
  TriangleMesh one;
  made::addTriangle(one, Vec3(0, 0, 0), Vec3(0.02, 0, 0), Vec3(0, 0.02, 0));
  EXPECT_THAT(refusalOf(one), HasSubstr("open in 1 place"));
  EXPECT_EQ(mend(one, {.sheet_thickness_m = 0.002}).mesh.triangles.size(), 1U);
}

TEST(Mend, RefusesWhatNobodyMayGive) {
  TriangleMesh mesh = made::cube(0.02);
  EXPECT_THAT(refusalOf(mesh, {.sheet_thickness_m = -0.001}), HasSubstr("sheet_thickness_m"));
  EXPECT_THAT(refusalOf(mesh, {.sheet_thickness_m = std::nan("")}), HasSubstr("sheet_thickness_m"));
  mesh.triangles[3][1] = 1000;
  EXPECT_THAT(refusalOf(mesh), HasSubstr("indices of finite points"));
  mesh = made::cube(0.02);
  mesh.points_m[3].y() = std::nan("");
  EXPECT_THAT(refusalOf(mesh), HasSubstr("indices of finite points"));
}

TEST(Mend, RefusesAFinThatHangsOnASolid) {
  TriangleMesh mesh = made::cube(0.02);
  made::addTriangle(mesh, Vec3(0.01, 0.01, -0.01), Vec3(0.01, 0.01, 0.01), Vec3(0.03, 0.03, 0));  // an edge of three
  EXPECT_THAT(refusalOf(mesh), HasSubstr("open in"));
}

TEST(Mend, BearsAnEdgeOfFourTriangles) {
  const MendedMesh mended =
      mend(made::together(made::cube(0.02, Vec3(0.01, 0.01, 0)), made::cube(0.02, Vec3(-0.01, -0.01, 0))));
  EXPECT_TRUE(isClosed(mended.mesh));
  EXPECT_EQ(mended.shell_count, 2);
  EXPECT_NEAR(made::volume_m3(mended.mesh), 2 * kCube_m3, 1e-15);
}

TEST(Mend, RefusesASurfaceWithOneSide) {
  TriangleMesh strip;  // Moebius strip
  const auto at = [](int i, double across) -> Vec3 {
    const double turn = 2 * std::numbers::pi * i / 20;
    const double out = 0.05 + across * std::cos(turn / 2);
    return {out * std::cos(turn), out * std::sin(turn), across * std::sin(turn / 2)};
  };
  for (int i = 0; i < 19; ++i) {
    made::addQuad(strip, at(i, -0.01), at(i + 1, -0.01), at(i + 1, 0.01), at(i, 0.01));
  }
  made::addQuad(strip, at(19, -0.01), at(0, 0.01), at(0, -0.01), at(19, 0.01));
  EXPECT_THAT(refusalOf(strip), HasSubstr("one-sided"));
  EXPECT_EQ(mend(strip, {.sheet_thickness_m = 0.002}).sheet_thickness_m, 0.002);
}

TEST(Mend, KeepsACavityOnlyWhereTheFileHasIt) {
  const TriangleMesh outer = made::cube(0.04);
  const TriangleMesh inner = made::cube(0.02);
  const double outer_m3 = 8 * kCube_m3;
  const auto volume = [](const TriangleMesh& mesh) { return made::volume_m3(mend(mesh).mesh); };
  EXPECT_NEAR(volume(made::together(outer, made::insideOut(inner))), outer_m3 - kCube_m3, 1e-12);
  EXPECT_NEAR(volume(made::together(made::insideOut(outer), inner)), outer_m3 - kCube_m3, 1e-12) << "all inside out";
  EXPECT_NEAR(volume(made::together(outer, inner)), outer_m3 + kCube_m3, 1e-12) << "both outwards: a union";
  TriangleMesh mixed = made::insideOut(inner);
  std::swap(mixed.triangles[0][1], mixed.triangles[0][2]);
  EXPECT_NEAR(volume(made::together(outer, mixed)), outer_m3 + kCube_m3, 1e-12) << "not all of it looked inwards";
  // Side by side, or intersecting, there is no cavity.
  EXPECT_NEAR(volume(made::together(inner, made::insideOut(made::cube(0.02, Vec3(0.05, 0, 0))))), 2 * kCube_m3, 1e-12);
  EXPECT_NEAR(volume(made::together(outer, made::insideOut(made::cube(0.02, Vec3(0.02, 0, 0))))), outer_m3 + kCube_m3,
              1e-12);
}

}  // namespace
}  // namespace haptolith

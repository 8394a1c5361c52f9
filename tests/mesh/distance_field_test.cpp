#include "haptolith/mesh/distance_field.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/mesh/outer_surface.h"
#include "haptolith/mesh/triangle_tree.h"

#include "made_meshes.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Points in a cube about the origin, the same in every run.
class Points {
 public:
  explicit Points(double half_m) : along_m_(-half_m, half_m) {}
  Vec3 next() { return {along_m_(random_), along_m_(random_), along_m_(random_)}; }

 private:
  std::mt19937 random_{7};
  std::uniform_real_distribution<double> along_m_;
};

DistanceField fieldOf(const TriangleMesh& mesh, const DistanceFieldOptions& options = {}, double sheet_m = 0) {
  return makeDistanceField(mend(mesh, {.sheet_thickness_m = sheet_m}), options);
}

std::string refusalOf(const TriangleMesh& mesh, const DistanceFieldOptions& options = {}, double sheet_m = 0) {
  try {
    (void)fieldOf(mesh, options, sheet_m);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "accepted";
}

TEST(TriangleTree, FindsTheNearestAsBruteForceDoes) {
  TriangleMesh mesh = made::together(made::sphere(0.03, 20), made::tube(0.02, 0.001, 0.08, 30));
  made::addTriangle(mesh, Vec3(0.01, 0, 0), Vec3(0.02, 0, 0), Vec3(0.03, 0, 0));  // a line
  made::addTriangle(mesh, Vec3(0.05, 0.05, 0), Vec3(0.05, 0.05, 0), Vec3(0.05, 0.05, 0));
  const TriangleTree tree(mesh, 2);
  Points points(0.1);
  std::int32_t hint = -1;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 point_m = points.next();
    double brute_m2 = std::numeric_limits<double>::infinity();
    for (const auto& triangle : mesh.triangles) {
      brute_m2 = std::min(brute_m2, squaredDistance(point_m, cornersOf(mesh, triangle)));
    }
    const TriangleTree::Nearest nearest = tree.nearest(point_m, 1, hint);
    ASSERT_EQ(nearest.squared_m2, brute_m2);
    hint = nearest.place;
    EXPECT_EQ(tree.nearest(point_m, 0.999 * std::sqrt(brute_m2)).place, -1);
  }
}

TEST(TriangleTree, DistanceToATriangleIsThatToItsNearestPoint) {
  Points points(1);
  for (int i = 0; i < 300; ++i) {
    const std::array<Vec3, 3> t{points.next(), points.next(), i % 10 == 0 ? Vec3(points.next() * 1e-9) : points.next()};
    const Vec3 point = points.next();
    constexpr int kSteps = 200;
    double least = std::numeric_limits<double>::infinity();
    for (int a = 0; a <= kSteps; ++a) {
      for (int b = 0; a + b <= kSteps; ++b) {
        const double u = static_cast<double>(a) / kSteps;
        const double v = static_cast<double>(b) / kSteps;
        least = std::min(least, (point - (1 - u - v) * t[0] - u * t[1] - v * t[2]).norm());
      }
    }
    const double distance = std::sqrt(squaredDistance(point, t));
    EXPECT_LE(distance, least + 1e-12);
    EXPECT_GE(distance, least - 3.5 / kSteps);
    EXPECT_GE(distance * distance, least * least - 16.0 / kSteps / kSteps * 4) << "the grid's nearest point is near";
  }
}

TEST(TriangleTree, GoesRoundPointsInsideAlongEveryAxis) {
  const TriangleMesh mesh = mend(made::sphere(0.03, 20)).mesh;
  const TriangleTree tree(mesh);
  Points points(0.04);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 point_m = points.next();
    if (std::abs(point_m.norm() - 0.03) > 1e-3) {
      for (const int axis : {0, 1, 2}) {
        EXPECT_EQ(tree.winding(point_m, axis), point_m.norm() < 0.03 ? 1 : 0);
      }
    }
  }
  for (const int axis : {0, 1, 2}) {
    EXPECT_EQ(tree.winding(Vec3::Zero(), axis), 1) << "through corners and edges";
  }
}

TEST(DistanceField, IsTheDistanceToABox) {
  const Vec3 half_m(0.02, 0.013, 0.005);
  const DistanceField field = fieldOf(made::box(-half_m, half_m));
  EXPECT_THAT(field.report(), IsEmpty());
  EXPECT_LT((field.corners().high_m - half_m).norm() + (field.corners().low_m + half_m).norm(), 1e-12);
  EXPECT_NEAR(field.enclosingRadius(), half_m.norm(), 1e-12);
  Points points(0.03);
  double worst_m = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Vec3 point_m = points.next();
    const auto [distance_m, gradient] = field.at(point_m);
    const double exact_m = std::clamp(made::distanceToBox_m(point_m, half_m), -field.band(), field.band());
    worst_m = std::max(worst_m, std::abs(distance_m - exact_m));
    EXPECT_NEAR(gradient.norm(), 1, 1e-12);
  }
  EXPECT_LT(worst_m, field.spacing() / 2) << "at edges, where it bends between two points";
  EXPECT_GT(worst_m, field.spacing() / 50) << "trilinear is not exact there";
  // Over the middle of a face it is linear, and so exact.
  for (double z_m = -0.004; z_m < 0.009; z_m += 0.00013) {
    const auto [distance_m, gradient] = field.at({0.0021, -0.0033, z_m});
    EXPECT_NEAR(distance_m, std::abs(z_m) - half_m.z(), 1e-8);
    if (std::abs(z_m) > field.spacing()) {
      EXPECT_LT((gradient - Vec3(0, 0, z_m > 0 ? 1 : -1)).norm(), 1e-5);
    }
  }
}

TEST(DistanceField, IsExactAtTheGridsPoints) {
  const MendedMesh mended = mend(made::sphere(0.02, 20));
  const DistanceField field = makeDistanceField(mended, {.spacing_m = 0.5e-3, .band_m = 3e-3});
  const TriangleTree tree(mended.mesh);
  // The grid is about the middle of the mesh, a whole number of blocks of eight cells wide.
  int near = 0;
  for (int i = -50; i <= 50; i += 5) {
    for (int j = -50; j <= 50; j += 5) {
      for (int k = -50; k <= 50; k += 5) {
        const Vec3 point_m = field.spacing() * Vec3(i, j, k);
        double brute_m2 = std::numeric_limits<double>::infinity();
        if (std::abs(point_m.norm() - 0.02) < 2.5e-3) {
          for (const auto& triangle : mended.mesh.triangles) {
            brute_m2 = std::min(brute_m2, squaredDistance(point_m, cornersOf(mended.mesh, triangle)));
          }
          const double exact_m = std::copysign(std::sqrt(brute_m2), tree.winding(point_m, 0) > 0 ? -1.0 : 1.0);
          EXPECT_NEAR(field.at(point_m).distance_m, exact_m, 2e-9);
          ++near;
        }
      }
    }
  }
  EXPECT_GT(near, 150);
}

TEST(DistanceField, IsTheDistanceToASphereWithItsGradient) {
  constexpr double kRadius_m = 0.0125;
  const DistanceField field = fieldOf(made::sphere(kRadius_m, 60), {.band_m = 3e-3});
  Points points(0.018);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 point_m = points.next();
    const double exact_m = std::clamp(point_m.norm() - kRadius_m, -field.band(), field.band());
    const auto [distance_m, gradient] = field.at(point_m);
    EXPECT_NEAR(distance_m, exact_m, 4e-5) << "flat triangles, and the bend between points";
    if (std::abs(exact_m) < 0.9 * field.band()) {
      EXPECT_GT(gradient.dot(point_m.normalized()), 0.995);
    }
  }
}

TEST(DistanceField, KnowsBothSidesOfAWallOfOneMillimetre) {
  constexpr double kOuter_m = 0.015;
  constexpr double kWall_m = 1e-3;
  const DistanceField field = fieldOf(made::tube(kOuter_m, kWall_m, 0.03, 180), {.band_m = 4e-3});
  for (int turn = 0; turn < 360; turn += 7) {
    const double angle = turn * std::numbers::pi / 180;
    const Vec3 out(std::cos(angle), std::sin(angle), 0);
    for (double r_m = kOuter_m - 4e-3; r_m < kOuter_m + 4e-3; r_m += 0.05e-3) {
      const double exact_m = std::abs(r_m - kOuter_m + kWall_m / 2) - kWall_m / 2;
      const auto [distance_m, gradient] = field.at(r_m * out + Vec3(0, 0, 0.0053));
      // Half a spacing in its middle, where distances bend; less at its faces.
      EXPECT_NEAR(distance_m, exact_m, std::abs(exact_m) < 0.1e-3 ? 0.05e-3 : 0.21e-3) << r_m;
      if (std::abs(exact_m) > 0.15e-3) {
        EXPECT_EQ(distance_m < 0, exact_m < 0) << r_m;
      }
      if (exact_m > 0.4e-3) {
        EXPECT_GT(gradient.dot(out) * (r_m > kOuter_m ? 1 : -1), 0.99) << "away from the wall on both sides";
      }
    }
    EXPECT_LT(field.at((kOuter_m - kWall_m / 2) * out).distance_m, -0.3e-3) << "its middle is inside";
  }
  EXPECT_EQ(field.at(Vec3::Zero()).distance_m, field.band()) << "the tube is hollow";
}

TEST(DistanceField, RefusesWallsThatItWouldNotSee) {
  EXPECT_THAT(refusalOf(made::tube(0.03, 0.5e-3, 0.08, 180)),
              AllOf(HasSubstr("spacing_m = 0.0004"), HasSubstr("0.5 mm thick")));
  EXPECT_EQ(refusalOf(made::tube(0.01, 0.5e-3, 0.01, 60), {.spacing_m = 0.24e-3, .band_m = 1e-3}), "accepted");
  // The edge of a blade is no wall.
  TriangleMesh wedge = made::box(Vec3(-0.02, -0.01, 0), Vec3(0.02, 0.01, 0.03));
  for (Vec3& point_m : wedge.points_m) {
    point_m.y() *= point_m.z() / 0.03;
  }
  EXPECT_EQ(refusalOf(wedge, {.band_m = 1e-3}), "accepted");
}

TEST(DistanceField, OfPartsThatPassThroughEachOtherIsThatOfTheirUnion) {
  const Vec3 shift_m(0.011, 0.007, 0.005);
  const DistanceField field = fieldOf(made::together(made::cube(0.02), made::cube(0.02, shift_m)));
  const Vec3 half_m = Vec3::Constant(0.01);
  Points points(0.02);
  int inside = 0;
  for (int i = 0; i < 50'000; ++i) {
    const Vec3 point_m = points.next() + shift_m / 2;
    const double first_m = made::distanceToBox_m(point_m, half_m);
    const double second_m = made::distanceToBox_m(point_m - shift_m, half_m);
    const double distance_m = field.at(point_m).distance_m;
    const double outside_m = std::min(first_m, second_m);
    if (outside_m > 0) {
      EXPECT_NEAR(distance_m, std::min(outside_m, field.band()), 0.25e-3);
    } else {  // at least as deep as in the deeper part
      EXPECT_LE(distance_m, std::max(outside_m, -field.band()) + 0.25e-3);
      ++inside;
    }
  }
  EXPECT_GT(inside, 5000);
  // On a face of one, deep in the other: the union's surface is 4.5 mm away or more.
  EXPECT_LT(field.at(Vec3(0.01, 0.003, 0.002)).distance_m, -4e-3);
}

TEST(DistanceField, OfAShellInASolidIsThatOfTheSolid) {
  const DistanceField field = fieldOf(made::together(made::cube(0.03), made::cube(0.01)), {.spacing_m = 1e-3});
  EXPECT_EQ(field.at(Vec3(0.005, 0, 0)).distance_m, -field.band());
  EXPECT_EQ(field.at(Vec3::Zero()).distance_m, -field.band());
  const DistanceField hollow =
      fieldOf(made::together(made::cube(0.03), made::insideOut(made::cube(0.016))), {.spacing_m = 1e-3});
  EXPECT_NEAR(hollow.at(Vec3(0.006, 0, 0)).distance_m, 0.002, 1e-6);
  EXPECT_NEAR(hollow.at(Vec3(0.01, 0, 0)).distance_m, -0.002, 1e-6);
  EXPECT_EQ(hollow.at(Vec3::Zero()).distance_m, hollow.band());
}

TEST(DistanceField, OfASheetIsHalfItsThicknessLess) {
  TriangleMesh sheet;
  made::addQuad(sheet, Vec3(-0.03, -0.02, 0), Vec3(0.03, -0.02, 0), Vec3(0.03, 0.02, 0), Vec3(-0.03, 0.02, 0));
  const DistanceField field = fieldOf(sheet, {}, 0.002);
  for (double z_m = -0.005; z_m < 0.005; z_m += 0.0002) {
    EXPECT_NEAR(field.at({0.01, 0.003, z_m}).distance_m, std::abs(z_m) - 0.001, 0.2e-3);
  }
  EXPECT_NEAR(field.at({0.033, 0, 0}).distance_m, 0.002, 1e-5) << "beyond its edge, which is round";
  EXPECT_LT(field.at({0.01, 0.003, 0}).distance_m, -0.8e-3);
  EXPECT_NEAR(field.corners().high_m.z(), 0.001, 1e-12);
  EXPECT_THAT(refusalOf(sheet, {}, 0.0005), HasSubstr("walls 0.5 mm thick"));
  // Thicker than twice the band: its centre is also inside.
  EXPECT_EQ(fieldOf(sheet, {.band_m = 1e-3}, 0.02).at({0, 0, 0}).distance_m, -1e-3);
}

TEST(DistanceField, IsOutsideFarAwayAndForWhatIsNoPoint) {
  const DistanceField field = fieldOf(made::cube(0.04));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const Vec3& point_m : {Vec3(1, 2, 3), Vec3(1e300, 0, 0), Vec3(0, -kInfinity, 0), Vec3(0, 0, std::nan(""))}) {
    EXPECT_EQ(field.at(point_m).distance_m, field.band());
    EXPECT_NEAR(field.at(point_m).gradient.norm(), 1, 1e-12);
  }
  EXPECT_EQ(field.at(Vec3::Zero()).distance_m, -field.band());
}

TEST(DistanceField, IsTheSameForAnyNumberOfThreads) {
  const MendedMesh mended = mend(made::together(made::sphere(0.02, 24), made::cube(0.02, Vec3(0.015, 0, 0))));
  const auto hash = [&](int threads, double band_m = 3e-3) {
    return makeDistanceField(mended, {.spacing_m = 1.6e-3, .band_m = band_m, .threads = threads}).hash();
  };
  const std::uint64_t one = hash(1);
  EXPECT_EQ(hash(2), one);
  EXPECT_EQ(hash(5), one);
  EXPECT_NE(hash(1, 3.1e-3), one);
}

TEST(DistanceField, GrowsCoarserToFitItsMemoryAndSaysSo) {
  const DistanceField field = fieldOf(made::cube(0.05), {.most_bytes = std::size_t{4} << 20});
  EXPECT_LE(field.bytes(), std::size_t{4} << 20);
  EXPECT_GT(field.spacing(), 0.4e-3);
  EXPECT_THAT(field.report(), testing::ElementsAre(HasSubstr("0.4 mm would need more than 4 MiB")));
  EXPECT_NEAR(field.at({0.027, 0.001, 0.002}).distance_m, 0.002, 1e-6);
  EXPECT_THAT(refusalOf(made::tube(0.03, 1e-3, 0.08, 90), {.most_bytes = std::size_t{4} << 20}),
              HasSubstr("to fit into 4 MiB, and at most 0.0005"));
}

TEST(DistanceField, RefusesOptionsOutsideTheirRanges) {
  EXPECT_THAT(refusalOf(made::cube(0.02), {.spacing_m = 0}), HasSubstr("spacing_m"));
  EXPECT_THAT(refusalOf(made::cube(0.02), {.band_m = 0.04}), HasSubstr("band_m"));
  EXPECT_THAT(refusalOf(made::cube(0.02), {.band_m = std::nan("")}), HasSubstr("band_m"));
  EXPECT_THAT(refusalOf(made::cube(0.02), {.threads = 0}), HasSubstr("threads"));
  EXPECT_THROW((void)makeDistanceField({}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith

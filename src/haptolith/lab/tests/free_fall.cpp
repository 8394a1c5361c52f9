#include "haptolith/lab/tests/free_fall.h"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/apparatus/lab_bed.h"

namespace haptolith {

namespace {

/// Distance over diameter of particles in contact; the overlap is so small that loose ones barely fly apart.
constexpr double kTouching = 0.999;

/// Returns a close packing inside a sphere; with unequal particles each has the space of the largest.
std::vector<Vec3> ballOfSoil(const LabConditions& conditions, double radius_m, const Vec3& middle) {
  const SoilParameters& soil = conditions.soil;
  const double spread = soil.friction == FrictionModel::kContact ? soil.size_spread : 0;
  const double a = 2 * soil.radius_m * (kTouching + spread);
  const Vec3 along(a, 0, 0);
  const Vec3 across(a / 2, a * std::sqrt(3.0) / 2, 0);
  const Vec3 up(a / 2, a / (2 * std::sqrt(3.0)), a * std::sqrt(2.0 / 3));
  const int far = static_cast<int>(3 * radius_m / a) + 1;
  std::vector<Vec3> centres;
  for (int i = -far; i <= far; ++i) {
    for (int j = -far; j <= far; ++j) {
      for (int k = -far; k <= far; ++k) {
        const Vec3 from_middle = i * along + j * across + k * up;
        if (from_middle.norm() <= radius_m) {
          centres.emplace_back(middle + from_middle);
        }
      }
    }
  }
  return centres;
}

/// Returns twice the quadratic coefficient of the least-squares parabola through the points.
double curvature(const std::vector<std::vector<double>>& rows, std::size_t x, std::size_t y) {
  const double longest = rows.back()[x];
  Eigen::Matrix3d left = Eigen::Matrix3d::Zero();
  Vec3 right = Vec3::Zero();
  for (const std::vector<double>& row : rows) {
    const double t = row[x] / longest;
    const Vec3 powers(1, t, t * t);
    left += powers * powers.transpose();
    right += row[y] * powers;
  }
  const Vec3 fitted = left.ldlt().solve(right);
  return 2 * fitted.z() / (longest * longest);
}

}  // namespace

void validate(const FreeFallOptions& options) {
  requireInRange("ball_radii", options.ball_radii, {3, 12});
  requireInRange("fall_m", options.fall_m, {0.01, 5});
}

FreeFallResult freeFallTest(const LabConditions& conditions, const FreeFallOptions& options) {
  validate(options);
  validate(conditions.soil);
  requireInRange("gravity_m_s2", conditions.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  const double ball_m = options.ball_radii * conditions.soil.radius_m;
  // Loose particles drift apart slightly: the free space is as large as the sphere.
  const Vec3 start(0, 0, options.fall_m + 2 * ball_m);
  LabBox box;
  box.width_m = box.length_m = 4 * ball_m;
  LabBed bed(conditions, box, ballOfSoil(conditions, ball_m, start));

  FreeFallResult result;
  result.particles = bed.soil();
  result.trace.columns = {"time_s", "fallen_m", "free_fall_m"};
  const auto middle = [&bed] {
    double sum = 0;
    for (std::size_t i = 0; i < bed.soil(); ++i) {
      sum += bed.centre(i).z();
    }
    return sum / static_cast<double>(bed.soil());
  };
  const double before = middle();
  const double reach = conditions.soil.radius_m * 2;
  bed.run(std::sqrt(2 * options.fall_m / conditions.gravity_m_s2), "a clump falls", [&] {
    const double t = bed.time();
    result.trace.rows.push_back({t, before - middle(), conditions.gravity_m_s2 / 2 * t * t});
  });
  for (std::size_t i = 0; i < bed.soil(); ++i) {
    if (bed.centre(i).z() < reach) {
      throw Failure("the clump flew apart and met the floor before its fall was over");
    }
  }
  result.acceleration_ratio = curvature(result.trace.rows, 0, 1) / conditions.gravity_m_s2;
  return result;
}

void drawFreeFall(const OutputFile& path, const FreeFallResult& result, std::string_view title) {
  Figure figure(path, 760, 480);
  figure.data("fall", result.trace.rows);
  figure.command(fmt::format("set title {}", gnuplotQuoted(title)));
  figure.command("set xlabel 'time / s'; set ylabel 'fallen / m'; set grid lc '#dddddd'");
  figure.command("set yrange [*:*] reverse; set key bottom left");
  figure.command(
      fmt::format("plot $fall using 1:3 with lines lw 6 lc '#bbbbbb' title 'free fall', "
                  "$fall using 1:2 with lines lw 2 lc '#1f6fb4' title 'clump, {:.4f} g'",
                  result.acceleration_ratio));
  figure.save();
}

}  // namespace haptolith

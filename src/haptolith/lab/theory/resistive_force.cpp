#include "haptolith/lab/theory/resistive_force.h"

#include <array>
#include <cmath>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/tool/tool_surface.h"

namespace haptolith {

namespace {

constexpr int kTerms = 20;

/// Returns T_k, in the order of the table.
std::array<double, kTerms> monomials(double x1, double x2, double x3) noexcept {
  return {1,
          x1,
          x2,
          x3,
          x1 * x1,
          x2 * x2,
          x3 * x3,
          x1 * x2,
          x2 * x3,
          x3 * x1,
          x1 * x1 * x1,
          x2 * x2 * x2,
          x3 * x3 * x3,
          x1 * x2 * x2,
          x2 * x1 * x1,
          x2 * x3 * x3,
          x3 * x2 * x2,
          x3 * x1 * x1,
          x1 * x3 * x3,
          x1 * x2 * x3};
}

/// c_1^k, c_2^k, c_3^k of the supporting information of (Agarwal, Goldman, Kamrin 2023), Table S1.
///
/// Taken from copies of it: github.com/D-sorganization/UpstreamDrift (bunkershot3d), github.com/KKKobefeng/3D-RFT and
/// github.com/Hanneszz/3dRFT-py, and two more programs. Two numbers differ among these five: c_2 of x3 x2^2 is 0.18519
/// in three and 0.18589 in the two that share their origin; c_3 of x2 x3^2 is -0.02730 in four and -0.20770 in one. The
/// majority values are used here.
constexpr std::array<std::array<double, 3>, kTerms> kCoefficients{{
    {0.00212, -0.06796, -0.02634},   // 1
    {-0.02320, -0.10941, -0.03436},  // x1
    {-0.20890, 0.04725, 0.45256},    // x2
    {-0.43083, -0.06914, 0.00835},   // x3
    {-0.00259, -0.05835, 0.02553},   // x1^2
    {0.48872, -0.65880, -1.31290},   // x2^2
    {-0.00415, -0.11985, -0.05532},  // x3^2
    {0.07204, -0.25739, 0.06790},    // x1 x2
    {-0.02750, -0.26834, -0.16404},  // x2 x3
    {-0.08772, 0.02692, 0.02287},    // x3 x1
    {0.01992, -0.00736, 0.02927},    // x1^3
    {-0.45961, 0.63758, 0.95406},    // x2^3
    {0.40799, 0.08997, -0.00131},    // x3^3
    {-0.10107, 0.21069, -0.11028},   // x1 x2^2
    {-0.06576, 0.04748, 0.01487},    // x2 x1^2
    {0.05664, 0.20406, -0.02730},    // x2 x3^2
    {-0.09269, 0.18519, 0.10911},    // x3 x2^2
    {0.01892, 0.04934, -0.04097},    // x3 x1^2
    {0.01033, 0.13527, 0.07881},     // x1 x3^2
    {0.15120, -0.33207, -0.27519},   // x1 x2 x3
}};

/// Returns f1 n + f2 v - f3 z for a normal that points down or is level.
Vec3 responseOfDownwardElement(const Vec3& normal, const Vec3& direction) noexcept {
  const std::array<double, kTerms> terms = monomials(-direction.z(), std::abs(normal.z()), normal.dot(direction));
  Vec3 f = Vec3::Zero();
  for (std::size_t k = 0; k < kTerms; ++k) {
    f += terms[k] * Vec3(kCoefficients[k][0], kCoefficients[k][1], kCoefficients[k][2]);
  }
  return f.x() * normal + f.y() * direction - f.z() * Vec3::UnitZ();
}

/// Tolerance of a level normal: the response is discontinuous there, and must not depend on rounding.
constexpr double kLevel = 1e-9;

using Triangle = std::array<Vec3, 3>;

/// Halves the longest edge until no edge is longer than `longest_m`.
void subdivide(const Triangle& triangle, double longest_m, std::vector<Triangle>& pieces) {
  std::size_t longest = 0;
  double length_m = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double edge_m = (triangle[(i + 1) % 3] - triangle[i]).norm();
    if (edge_m > length_m) {
      length_m = edge_m;
      longest = i;
    }
  }
  if (length_m <= longest_m) {
    pieces.push_back(triangle);
    return;
  }
  const Vec3& a = triangle[longest];
  const Vec3& b = triangle[(longest + 1) % 3];
  const Vec3& c = triangle[(longest + 2) % 3];
  const Vec3 middle = (a + b) / 2;
  subdivide({a, middle, c}, longest_m, pieces);
  subdivide({middle, b, c}, longest_m, pieces);
}

/// Returns the corners of the part below `surface_m`, in order.
std::vector<Vec3> below(const Triangle& triangle, double surface_m) {
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& here = triangle[i];
    const Vec3& next = triangle[(i + 1) % 3];
    const double above_here = here.z() - surface_m;
    const double above_next = next.z() - surface_m;
    if (above_here <= 0) {
      corners.push_back(here);
    }
    if ((above_here < 0 && above_next > 0) || (above_here > 0 && above_next < 0)) {
      corners.emplace_back(here + above_here / (above_here - above_next) * (next - here));
    }
  }
  return corners;
}

double extent(const std::vector<Vec3>& points) {
  Vec3 lowest = points.front();
  Vec3 highest = points.front();
  for (const Vec3& point : points) {
    lowest = lowest.cwiseMin(point);
    highest = highest.cwiseMax(point);
  }
  return (highest - lowest).maxCoeff();
}

}  // namespace

Vec3 genericResponse(const ResistiveAngles& angles) noexcept {
  const double tilt = std::sin(angles.beta_rad);
  const Vec3 normal(tilt * std::cos(angles.psi_rad), tilt * std::sin(angles.psi_rad), -std::cos(angles.beta_rad));
  return responseOfDownwardElement(normal, {std::cos(angles.gamma_rad), 0, -std::sin(angles.gamma_rad)});
}

Vec3 genericResponse(const Vec3& normal, const Vec3& direction) noexcept {
  // The outside of an upright element points up, as in the published angles, with beta = -90 deg in front.
  return responseOfDownwardElement(normal.z() > -kLevel ? Vec3(-normal) : normal, direction);
}

double resistiveScale(const ResistiveSoil& soil) {
  requireInRange("density_kg_m3", soil.density_kg_m3, {0, 1e5, Ends::kOpenBelow});
  requireInRange("gravity_m_s2", soil.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  const double mu = requireInRange("internal_friction", soil.internal_friction, {0, 2, Ends::kOpenBelow});
  return soil.density_kg_m3 * soil.gravity_m_s2 * (894 * mu * mu * mu - 386 * mu * mu + 89 * mu);
}

Vec3 resistiveResponse(const Vec3& normal, const Vec3& velocity, double xi_n_m3, double mu_surf) noexcept {
  const double speed = velocity.norm();
  if (speed == 0 || normal.dot(velocity) < -kLevel * speed) {
    return Vec3::Zero();
  }
  const Vec3 alpha = genericResponse(normal, velocity / speed);
  const Vec3 across = alpha.dot(normal) * normal;
  const Vec3 along = alpha - across;
  const double limit = mu_surf * across.norm();
  const double along_norm = along.norm();
  return xi_n_m3 * (across + (along_norm > limit ? limit / along_norm : 1) * along);
}

Wrench resistiveForce(const ToolParameters& tool, double opening_m, const Pose& scene_T_tool, const Twist& twist,
                      const ResistiveSoil& soil) {
  validate(tool);
  const double xi_n_m3 = resistiveScale(soil);
  const ToolSurface surface = toolSurface(tool, opening_m);
  const double longest_m = extent(surface.points_tool_m) / 24;
  Wrench wrench;
  std::vector<Triangle> pieces;
  for (const auto& [a, b, c] : surface.triangles) {
    const auto corner = [&](std::int32_t point) {
      return scene_T_tool.fromBody(surface.points_tool_m[static_cast<std::size_t>(point)]);
    };
    const Triangle whole{corner(a), corner(b), corner(c)};
    const Vec3 normal = (whole[1] - whole[0]).cross(whole[2] - whole[0]).normalized();
    pieces.clear();
    subdivide(whole, longest_m, pieces);
    for (const Triangle& piece : pieces) {
      const std::vector<Vec3> under = below(piece, soil.surface_m);
      for (std::size_t i = 2; i < under.size(); ++i) {
        const Vec3 middle = (under[0] + under[i - 1] + under[i]) / 3;
        const double area_m2 = (under[i - 1] - under[0]).cross(under[i] - under[0]).norm() / 2;
        const Vec3 lever = middle - scene_T_tool.position_m;
        const Vec3 response = resistiveResponse(normal, twist.at(lever), xi_n_m3, tool.friction);
        wrench.add(response * (soil.surface_m - middle.z()) * area_m2, lever);
      }
    }
  }
  return wrench;
}

}  // namespace haptolith

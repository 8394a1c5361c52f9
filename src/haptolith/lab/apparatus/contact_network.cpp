#include "haptolith/lab/apparatus/contact_network.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "haptolith/bed/start/bed_tile.h"
#include "haptolith/core/math/random.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/tool/tool_shape.h"

namespace haptolith {

namespace {

/// Stiffness and damping of a contact between two particles of a soil.
class PairSprings {
 public:
  PairSprings(const SoilParameters& coarsest, int class_a, int class_b)
      : soil_(soilBetween(coarsest, class_a, class_b)),
        law_(makeContactLaw(soil_)),
        diameter_deficit_m_(2 * (coarsest.radius_m - soil_.radius_m)),
        per_root_(soil_.damping_ratio * std::sqrt(2 * massBetween(coarsest, class_a, class_b))) {}

  /// 2 (R_0 - R_pair): contact begins this much closer than for two of class 0, m.
  [[nodiscard]] double diameterDeficit() const noexcept { return diameter_deficit_m_; }

  [[nodiscard]] double reach() const noexcept { return law_.cutoff_m; }

  /// @param ratio  friction and cohesion over the soil's, as for walls.
  /// @param towards  approach speed of the two over the speed of the first: 2 with a mirror image.
  void set(ContactLink& link, double a_m, double ratio = 1, double towards = 1) const noexcept {
    const double hyperbola = law_.gamma_nm / std::pow(std::max(a_m, law_.a_thr_m) - law_.a_min_m, 2);
    const double gap_m = a_m - law_.diameter_m;
    const double middle_m = law_.cohesion_range_m / 2;  // cohesion grows with the gap up to here
    const double cohesion_n_m =
        4 * ratio * law_.cohesion_n / law_.cohesion_range_m * std::max(0.0, 1 - gap_m / middle_m);
    const double k = gap_m < 0 ? hyperbola : cohesion_n_m;
    const bool sticks =
        ratio > 0 && soil_.contact_friction > 0 && (gap_m < 0 || (law_.cohesion_n > 0 && gap_m < middle_m));
    const double k_t = sticks ? soil_.tangential_ratio * soil_.stiffness_n_m : 0;
    link.stiffness_n_m = {towards * k, k_t};
    link.damping_n_s_m = {towards * per_root_ * std::sqrt(hyperbola), per_root_ * std::sqrt(k_t)};
  }

 private:
  SoilParameters soil_;
  ContactLaw law_;
  double diameter_deficit_m_;
  double per_root_;  ///< c / sqrt(k)
};

Vec3 vec(const Float4& f) {
  return {f.x, f.y, f.z};
}

void addWalls(ContactNetwork& network, const Bed& bed, const PairSprings& springs, std::size_t i) {
  const BedParameters& box = bed.parameters();
  const Float4& p = bed.state().position[i];
  const auto add = [&](double distance_m, const Vec3& normal, double ratio) {
    const double a_m = 2 * (distance_m - p.w) - springs.diameterDeficit();
    if (a_m < springs.reach()) {
      ContactLink link{.first = static_cast<std::int32_t>(i), .normal = normal};
      springs.set(link, a_m, ratio, 2);
      network.links.push_back(link);
    }
  };
  add(p.z, Vec3::UnitZ(), 1);
  if (!box.periodic_x) {
    add(box.width_m / 2 + heldWidth(box) - std::abs(p.x), Vec3::UnitX(), wallRatio(box));
  }
  if (!box.periodic_y) {
    add(box.length_m / 2 + heldWidth(box) - std::abs(p.y), Vec3::UnitY(), wallRatio(box));
  }
}

double around(double apart_m, double period_m, bool periodic) {
  return periodic ? apart_m - period_m * std::round(apart_m / period_m) : apart_m;
}

using Weight = std::function<AlongAndAcross(const ContactLink&)>;

/// Largest eigenvalue of sum over links of along n n^T + across (1 - n n^T), each between its two particles, by the
/// Lanczos method. The upper end of a packing's spectrum is dense: after a hundred products power iteration is still
/// 1 % too low, Lanczos has an error of 1e-6. Lost orthogonality only repeats eigenvalues.
double largestEigenvalue(const ContactNetwork& network, const Weight& weight) {
  std::vector<AlongAndAcross> weights;
  for (const ContactLink& link : network.links) {
    weights.push_back(weight(link));
  }
  using Movement = Eigen::Matrix3Xd;
  Eigen::VectorXd lighter(std::ssize(network.mass_ratio));  // 1 / sqrt(m)
  for (Eigen::Index i = 0; i < lighter.size(); ++i) {
    lighter[i] = 1 / std::sqrt(network.mass_ratio[static_cast<std::size_t>(i)]);
  }
  const auto times = [&](const Movement& x) {
    // In coordinates x sqrt(m), in which all particles have the same mass.
    const Movement moved = lighter.size() == 0 ? x : Movement(x * lighter.asDiagonal());
    Movement force = Movement::Zero(3, x.cols());
    for (std::size_t l = 0; l < network.links.size(); ++l) {
      const ContactLink& link = network.links[l];
      const Vec3 apart =
          link.second < 0 ? Vec3(moved.col(link.first)) : Vec3(moved.col(link.first) - moved.col(link.second));
      const Vec3 pull =
          weights[l].across * apart + (weights[l].along - weights[l].across) * link.normal.dot(apart) * link.normal;
      force.col(link.first) += pull;
      if (link.second >= 0) {
        force.col(link.second) -= pull;
      }
    }
    return lighter.size() == 0 ? force : Movement(force * lighter.asDiagonal());
  };
  constexpr int kMostProducts = 150;
  std::mt19937_64 random(1);
  Movement now(3, static_cast<Eigen::Index>(network.particles));
  for (double& x : now.reshaped()) {
    x = uniformSigned(random);
  }
  now.normalize();
  Movement before = Movement::Zero(3, now.cols());
  std::vector<double> diagonal, beside;
  while (static_cast<int>(diagonal.size()) < kMostProducts) {
    Movement next = times(now);
    diagonal.push_back(next.cwiseProduct(now).sum());
    next -= diagonal.back() * now + (beside.empty() ? 0 : beside.back()) * before;
    const double left = next.norm();
    if (left <= 1e-9 * std::abs(diagonal.front())) {  // the Krylov space is exhausted
      break;
    }
    beside.push_back(left);
    before = now;
    now = next / left;
  }
  beside.resize(diagonal.size() - 1);
  // Scaled to the order of 1: Eigen drops an off-diagonal value once it is small compared with the root of the
  // diagonal. With large numbers it stops before that, with wrong eigenvalues.
  const double size = *std::ranges::max_element(diagonal);
  if (size <= 0) {
    return 0;  // no contacts
  }
  const Eigen::VectorXd on = Eigen::Map<Eigen::VectorXd>(diagonal.data(), std::ssize(diagonal)) / size;
  const Eigen::VectorXd off = Eigen::Map<Eigen::VectorXd>(beside.data(), std::ssize(beside)) / size;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(on, off, Eigen::EigenvaluesOnly);
  return size * solver.eigenvalues().maxCoeff();
}

}  // namespace

ContactNetwork contactNetwork(const Bed& bed) {
  const BedState& state = bed.state();
  const BedParameters& box = bed.parameters();
  const int classes = bed.classes().count();
  std::vector<std::vector<PairSprings>> pairs(static_cast<std::size_t>(classes));
  for (int a = 0; a < classes; ++a) {
    for (int b = 0; b < classes; ++b) {
      pairs[static_cast<std::size_t>(a)].push_back(PairSprings(box.soil, a, b));
    }
  }
  const auto between = [&](std::size_t i, std::size_t j) -> const PairSprings& {
    return pairs[static_cast<std::size_t>(bed.classOf(i))][static_cast<std::size_t>(bed.classOf(j))];
  };
  ContactNetwork network{.particles = bed.particles(), .mass_kg = bed.mass(), .links = {}};
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    if (classes > 1) {
      network.mass_ratio.push_back(GrainClasses::scale(3 * bed.classOf(i)));
    }
    for (std::uint32_t s = 0; s < state.contacts.count(i); ++s) {
      const auto j = static_cast<std::size_t>(state.contacts.neighbour(i, s));
      if (j < i || (bed.isDriven(i) && bed.isDriven(j))) {
        continue;
      }
      Vec3 apart = vec(state.position[i]) - vec(state.position[j]);
      apart.x() = around(apart.x(), box.width_m, box.periodic_x);
      apart.y() = around(apart.y(), box.length_m, box.periodic_y);
      const PairSprings& springs = between(i, j);
      const double a_m = apart.norm() - state.position[i].w - state.position[j].w - springs.diameterDeficit();
      if (a_m < springs.reach()) {
        const std::size_t first = bed.isDriven(i) ? j : i;
        const std::size_t second = bed.isDriven(i) ? i : j;
        ContactLink link{.first = static_cast<std::int32_t>(first),
                         .second = bed.isDriven(second) ? ContactLink::kFixed : static_cast<std::int32_t>(second),
                         .normal = apart.normalized()};
        springs.set(link, a_m);
        network.links.push_back(link);
      }
    }
    if (!bed.isDriven(i)) {
      addWalls(network, bed, between(i, i), i);
    }
  }
  return network;
}

void addTool(ContactNetwork& network, const ToolParameters& tool, const Pose& scene_T_tool, double dt_s,
             const Bed& bed) {
  const BedState& state = bed.state();
  const SoilParameters& soil = bed.parameters().soil;
  const Eigen::Matrix3d rotation = scene_T_tool.orientation.toRotationMatrix();
  const double damping_s = tool.damping_factor * dt_s / 2;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Vec3 centre_m = rotation.transpose() * (vec(state.position[i]) - scene_T_tool.position_m);
    const double radius_m = soil.radius_m + state.position[i].w;
    const auto add = [&](const Penetration& contact, double share) {
      if (contact.depth_m > 0 && !bed.isDriven(i)) {
        const double k = share * GrainClasses::scale(bed.classOf(i)) * tool.stiffness_n_m;
        const double k_t = tool.friction > 0 ? soil.tangential_ratio * k : 0;
        network.links.push_back({.first = static_cast<std::int32_t>(i),
                                 .normal = rotation * contact.outward,
                                 .stiffness_n_m = {k, k_t},
                                 .damping_n_s_m = {damping_s * k, damping_s * k_t}});
      }
    };
    if (tool.shape == ToolShape::kJaws) {
      for (const JawContact& jaw : jawContacts(tool, centre_m, radius_m, 0).jaws) {
        add(jaw.found, jaw.share);
      }
    } else {
      add(penetration(tool, centre_m, radius_m, 0), 1);
    }
  }
}

double largestFrequencySquared(const ContactNetwork& network) {
  return largestEigenvalue(network, [](const ContactLink& link) { return link.stiffness_n_m; }) / network.mass_kg;
}

double shareOfStableStep(const ContactNetwork& network, double dt_s) {
  const auto asked = [dt_s](const ContactLink& link) {
    const auto of = [dt_s](double k, double c) { return dt_s * dt_s * k + 2 * dt_s * c; };
    return AlongAndAcross{of(link.stiffness_n_m.along, link.damping_n_s_m.along),
                          of(link.stiffness_n_m.across, link.damping_n_s_m.across)};
  };
  return largestEigenvalue(network, asked) / (4 * network.mass_kg);
}

}  // namespace haptolith

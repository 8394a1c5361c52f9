#include "haptolith/identify/model_learner.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "haptolith/lab/theory/earthmoving.h"

namespace haptolith {

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kScatter = 0.2;         ///< relative SD of a stretch's force between specimens
constexpr double kGrowth = 0.4;          ///< relative error of the growth law, per log of the growth
constexpr double kLearnerNoise_n = 0.1;  ///< noise of a sensor, and of impacts of single particles
constexpr double kFreedom = 4;           ///< nu of Student's t
constexpr double kAlike = 2;             ///< number of consecutive, correlated stretches that count as one
constexpr double kFarShare = 0.05;
constexpr int kMostSteps = 12;
constexpr SoilPrior kBounds{.friction_angle_deg{12, 50}, .cohesion_m{0, 1.5}, .tool_friction{0.05, 0.7}};

StateVector within(const StateVector& state) {
  return state.cwiseMax(lowest(kBounds)).cwiseMin(highest(kBounds));
}

}  // namespace

ModelLearner::ModelLearner(const Prior& prior, double density_kg_m3, double gravity_m_s2)
    : prior_(prior), density_kg_m3_(density_kg_m3), gravity_m_s2_(gravity_m_s2) {}

void ModelLearner::add(const DiggingStretch& stretch) {
  stretches_.push_back(stretch);
  if (stretches_.size() > kMostStretches) {
    stretches_.pop_front();
  }
}

double ModelLearner::forceAlong(const ToolCut& cut, const SoilState& state) const {
  // The equation holds for blades that are upright or lean back; the growth of force is similar for others.
  constexpr double kFlattest = 40 * kDegree, kSteepest = 85 * kDegree;
  BladeCase blade;
  blade.width_m = 1;
  blade.depth_m = cut.depth_m;
  blade.rake_rad = std::clamp(cut.rake_rad, kFlattest, kSteepest);
  blade.density_kg_m3 = density_kg_m3_;
  blade.gravity_m_s2 = gravity_m_s2_;
  blade.friction_angle_rad = state.friction_angle_deg * kDegree;
  blade.tool_friction_rad = std::atan(state.tool_friction);
  blade.cohesion_pa = state.cohesion_pa;
  return earthmovingForce(blade).force_n;
}

ModelSoil ModelLearner::at(const Vec3& place_m) const {
  // Quantities that do not depend on the state.
  struct Known {
    Vec3 axis, displayed_n, met_n;
    const ToolCut* cut;
    double model_force, model_delta_rad, weight;
  };
  std::vector<Known> known;
  known.reserve(stretches_.size());
  double stretches = 0;
  for (const DiggingStretch& stretch : stretches_) {
    const double away = (stretch.place_m - place_m).head<2>().norm() / kReach_m;
    const double weight = kFarShare + (1 - kFarShare) * std::exp(-away * away / 2);
    stretches += weight;
    known.push_back({Vec3::UnitZ().cross(stretch.cut.ahead), stretch.displayed_n, stretch.met_n, &stretch.cut,
                     forceAlong(stretch.cut, stretch.model), std::atan(stretch.model.tool_friction), weight / kAlike});
  }
  const StateVector first = stateVector(prior_.middle, gravity_m_s2_);
  const Eigen::Vector3d sd(prior_.angle_deg, prior_.cohesion_log, prior_.tool_friction);

  const auto predicted = [&](const Known& stretch, const StateVector& vector) -> Vec3 {
    const SoilState state = soilState(vector, gravity_m_s2_);
    const double turn_rad = std::atan(state.tool_friction) - stretch.model_delta_rad;
    // Soil that slides up the blade pushes it up: more friction rotates the force from backwards to upwards.
    return forceAlong(*stretch.cut, state) / stretch.model_force *
           (Eigen::AngleAxisd(turn_rad, stretch.axis) * stretch.displayed_n);
  };

  StateVector state = within(first);
  Eigen::Matrix3d precision = sd.cwiseAbs2().cwiseInverse().asDiagonal();
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::Matrix3d hessian = sd.cwiseAbs2().cwiseInverse().asDiagonal();
    Eigen::Vector3d gradient = hessian * (first - state);
    const Eigen::Vector3d probe(0.5, 0.05, 0.02);
    for (const Known& stretch : known) {
      const Vec3 expected_n = predicted(stretch, state);
      const Vec3 apart_n = stretch.met_n - expected_n;
      Eigen::Matrix3d slopes;
      for (int axis = 0; axis < 3; ++axis) {
        StateVector moved = state;
        const double by = state[axis] > highest(kBounds)[axis] - probe[axis] ? -probe[axis] : probe[axis];
        moved[axis] += by;
        slopes.col(axis) = (predicted(stretch, moved) - expected_n) / by;
      }
      // A force rendered by a model far from this state has less weight.
      const double growth = std::log(expected_n.norm() / stretch.displayed_n.norm());
      const double size_n = std::max(stretch.met_n.norm(), expected_n.norm());
      const double sd_n = std::hypot(std::hypot(kScatter, kGrowth * growth) * size_n, kLearnerNoise_n);
      const double variance = sd_n * sd_n;
      const double counts = stretch.weight / variance * (kFreedom + 3) / (kFreedom + apart_n.squaredNorm() / variance);
      hessian += counts * slopes.transpose() * slopes;
      gradient += counts * slopes.transpose() * apart_n;
    }
    const StateVector next = within(state + hessian.llt().solve(gradient));
    const bool settled = ((next - state).array().abs() < 0.1 * probe.array()).all();
    state = next;
    precision = hessian;
    if (settled) {
      break;
    }
  }
  const Eigen::Vector3d deviation = precision.inverse().diagonal().cwiseSqrt();
  constexpr double kNinety = 1.645;
  const StateVector low = within(state - kNinety * deviation), high = within(state + kNinety * deviation);
  ModelSoil soil;
  soil.state = soilState(state, gravity_m_s2_);
  const SoilState least = soilState(low, gravity_m_s2_), most = soilState(high, gravity_m_s2_);
  const auto angle_deg = [](const SoilState& of) { return std::atan(of.tool_friction) / kDegree; };
  soil.friction_angle_deg = {least.friction_angle_deg, soil.state.friction_angle_deg, most.friction_angle_deg};
  soil.cohesion_pa = {least.cohesion_pa, soil.state.cohesion_pa, most.cohesion_pa};
  soil.tool_friction_angle_deg = {angle_deg(least), angle_deg(soil.state), angle_deg(most)};
  soil.stretches = stretches;
  return soil;
}

}  // namespace haptolith

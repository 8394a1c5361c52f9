#pragma once

#include <cstddef>
#include <deque>

#include "haptolith/identify/soil_belief.h"
#include "haptolith/identify/tool_cut.h"

namespace haptolith {

/// Stretch of digging in which the forces of the model's soil and of the real soil on the tool are both known.
struct DiggingStretch {
  Vec3 place_m = Vec3::Zero();  ///< position of the tool, site frame
  ToolCut cut;
  SoilState model;  ///< strength of the model's soil
  Vec3 displayed_n = Vec3::Zero(), met_n = Vec3::Zero();
};

/// State of the model's soil that reproduces the forces of the real soil.
struct ModelSoil {
  SoilState state;
  SoilEstimate friction_angle_deg, cohesion_pa, tool_friction_angle_deg;
  double stretches = 0;  ///< effective number of stretches at this position
};

/// Estimates soil strength during digging along any path, from the ratio of the measured force to the force of the
/// model along the same path. An equation is needed only for the growth of force with strength:
///
///     met = s R displayed + e,    s = F(theta, cut) / F(model, cut)
///
/// R is a rotation by delta - delta_model about the axis across the path. F is that of the fundamental earthmoving
/// equation (earthmovingForce()) at the tool's depth and rake. Later stretches, with an updated strength of the model,
/// correct its errors. theta is the most probable state, by the Gauss-Newton method with Student's t for e, from all
/// stretches nearby, with a prior about the model's initial strength. Intervals are those of the normal distribution
/// there. The more the model of a stretch differs from theta, the less it counts: e grows with |ln s|.
///
/// theta is a strength of the model's kind of soil. If the real particles are of another kind, a shear test of them
/// would give a different result; SoilIdentifier estimates that.
class ModelLearner {
 public:
  struct Prior {
    SoilState middle;
    double angle_deg = 10, cohesion_log = 1, tool_friction = 0.15;  ///< standard deviations; of ln(c + 30 mm rho g)
  };
  ModelLearner(const Prior& prior, double density_kg_m3, double gravity_m_s2);

  void add(const DiggingStretch& stretch);

  /// Returns the most probable soil at a position. Weights of stretches fall with distance, down to a twentieth. Takes
  /// about 10 ms. Not for the tick.
  [[nodiscard]] ModelSoil at(const Vec3& place_m) const;

  [[nodiscard]] std::size_t stretches() const noexcept { return stretches_.size(); }

  static constexpr std::size_t kMostStretches = 300;
  static constexpr double kReach_m = 0.06;  ///< length over which soil is assumed to be uniform

  /// Returns F of the earthmoving equation for a cut, per width, in N/m.
  [[nodiscard]] double forceAlong(const ToolCut& cut, const SoilState& state) const;

 private:
  Prior prior_;
  double density_kg_m3_, gravity_m_s2_;
  std::deque<DiggingStretch> stretches_;
};

}  // namespace haptolith

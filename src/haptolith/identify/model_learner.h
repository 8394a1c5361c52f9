#pragma once

#include <cstddef>
#include <deque>

#include "haptolith/identify/soil_belief.h"
#include "haptolith/identify/tool_cut.h"

namespace haptolith {

/// A stretch of digging in which the force of a model's soil on the tool and that of the real soil are both known.
struct DiggingStretch {
  Vec3 place_m = Vec3::Zero();  ///< of the tool, site frame
  ToolCut cut;
  SoilState model;  ///< how strong the model's soil was
  Vec3 displayed_n = Vec3::Zero(), met_n = Vec3::Zero();
};

/// What a model's soil has to be so that it does to a tool what the real soil does.
struct ModelSoil {
  SoilState state;
  SoilEstimate friction_angle_deg, cohesion_pa, tool_friction_angle_deg;
  double stretches = 0;  ///< that count at this place
};

/// Learns while somebody digs, along whatever path: by how much the force that was met differs from the one that the
/// model gave along the same path. No equation has to be right about either, only about how force grows with strength:
///
///     met = s R felt + e,    s = F(theta, cut) / F(model, cut),    R turns by delta - delta_model about the axis
///     across
///
/// F is the fundamental earthmoving equation's (earthmovingForce()) at the tool's depth and rake. What it is wrong
/// about the next stretches put right, in which the model already has another strength. theta is the most probable
/// state, by Gauss and Newton with Student's t for e, from all stretches nearby, on a prior about the model's first
/// strength; intervals are those of the normal distribution there. A stretch counts less the more its model differed
/// from theta: e grows with |ln s|.
///
/// theta is a strength of the model's own kind of soil. Where the real grains are of another kind, it is not what a
/// shear test of them would measure: SoilIdentifier tells that.
class ModelLearner {
 public:
  struct Prior {
    SoilState middle;
    double angle_deg = 10, cohesion_log = 1, tool_friction = 0.15;  ///< standard deviations; of ln(c + 30 mm rho g)
  };
  ModelLearner(const Prior& prior, double density_kg_m3, double gravity_m_s2);

  void add(const DiggingStretch& stretch);

  /// The most probable soil at a place: stretches count less the further away they were, to a twentieth. Takes some
  /// ten milliseconds. Not for the tick.
  [[nodiscard]] ModelSoil at(const Vec3& place_m) const;

  [[nodiscard]] std::size_t stretches() const noexcept { return stretches_.size(); }

  static constexpr std::size_t kMostStretches = 300;
  static constexpr double kReach_m = 0.06;  ///< over which soil is held to be alike

  /// F of the earthmoving equation for such a cut, per width, in N/m.
  [[nodiscard]] double forceAlong(const ToolCut& cut, const SoilState& state) const;

 private:
  Prior prior_;
  double density_kg_m3_, gravity_m_s2_;
  std::deque<DiggingStretch> stretches_;
};

}  // namespace haptolith

#include "haptolith/tool/tool_contact.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "haptolith/bed/kernel/friction-inl.h"
#include "haptolith/core/assert.h"
#include "haptolith/tool/tool_box.h"
#include "haptolith/tool/tool_shape.h"

namespace haptolith {

double toolForce(const ToolParameters& tool, double radius_m, double dt_s, double depth_m,
                 double closing_m_s) noexcept {
  if (depth_m <= -tool.adhesion_ratio * radius_m) {
    return 0;
  }
  const double damping = tool.damping_factor * dt_s * tool.stiffness_n_m / 2;
  return tool.stiffness_n_m * depth_m + damping * closing_m_s;
}

double stiffnessInStep(const ToolParameters& tool, FrictionModel friction) noexcept {
  const double jaws = tool.shape == ToolShape::kJaws ? 2 : 1;
  return jaws * tool.stiffness_n_m * (friction == FrictionModel::kContact ? 1 + tool.damping_factor : 1);
}

double stiffnessInStep(std::span<const ToolParameters> tools, const SoilParameters& soil) noexcept {
  double stiffest = 0;
  double second = 0;
  for (const ToolParameters& tool : tools) {
    const double own = stiffnessInStep(tool, soil.friction);
    second = std::max(second, std::min(own, stiffest));
    stiffest = std::max(stiffest, own);
  }
  const double wall = 2 * soil.stiffness_n_m;
  return stiffest + std::max(second - wall, 0.0);
}

double contactReach(const ToolParameters& tool, const SoilParameters& soil) noexcept {
  const double outside_m = (1 + tool.adhesion_ratio) * soil.radius_m;
  if (soil.friction != FrictionModel::kContact) {
    return outside_m;
  }
  return outside_m + (soil.size_spread + (tool.adhesion_n > 0 ? soil.cohesion_range_ratio : 0)) * soil.radius_m;
}

double contactReach(const ToolParameters& tool, const BedParameters& bed) noexcept {
  return std::max(contactReach(tool, bed.soil), largestSphere(bed.stones));
}

namespace {

namespace law = HWY_NAMESPACE;

Float4 float4(const Vec3& v) noexcept {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}

/// Fraction of the tool's movement that a contact takes up: 1 when the particle stays where it is, 0 when it is
/// pushed along, carried or flees. Speeds of the tool against the particle, and of the tool.
double heldShare(double closing_m_s, double tool_speed_m_s) noexcept {
  return tool_speed_m_s == 0 ? 1 : std::clamp(closing_m_s / tool_speed_m_s, 0.0, 1.0);
}

/// One particle that the tool may touch.
struct Meeting {
  Vec3 outward;       ///< unit normal from the tool to the particle
  double depth_m;     ///< z of (paper 21)
  Vec3 tool_m_s;      ///< velocity of the tool's surface
  Vec3 particle_m_s;  ///< and of the particle

  [[nodiscard]] Vec3 approach() const { return tool_m_s - particle_m_s; }
};

struct Answer {
  Vec3 on_particle_n = Vec3::Zero();
  Eigen::Matrix3d stiffness_n_m = Eigen::Matrix3d::Zero();
};

/// Contacts of soil with contact friction.
class FrictionalTool {
 public:
  /// @param scale  R of the grains over that of the soil: k_tool ~ R and adhesion ~ R^2, as k and F_c of the soil.
  FrictionalTool(const ToolParameters& tool, const SoilParameters& soil, double dt_s, double scale)
      : stiffness_(scale * tool.stiffness_n_m),
        damping_(tool.damping_factor * dt_s * stiffness_ / 2),
        coefficient_(tool.friction),
        reach_m_(tool.adhesion_n > 0 ? soil.cohesion_range_ratio * scale * soil.radius_m : 0),
        adhesion_{scale * scale * tool.adhesion_n, 2 / (soil.cohesion_range_ratio * scale * soil.radius_m), 0, 1},
        tangential_stiffness_(soil.tangential_ratio * stiffness_),
        friction_{dt_s, -tangential_stiffness_, tool.damping_factor * dt_s / 2} {}

  [[nodiscard]] double reach() const noexcept { return reach_m_; }

  /// @param slip_m  how far the particle has slid along the tool so far, scene frame; read and written.
  Answer meet(const Meeting& meeting, Vec3& slip_m) const noexcept {
    HAPTO_ASSERT(stiffness_ >= 0 && tangential_stiffness_ >= 0);
    HAPTO_ASSERT(friction_.dt > 0);
    const Vec3& n = meeting.outward;
    if (meeting.depth_m <= -reach_m_) {
      slip_m.setZero();
      return {};
    }
    const law::Cohesion<double> adhesion = law::cohesionAcross(adhesion_, -meeting.depth_m);
    const double spring = stiffness_ * std::max(meeting.depth_m, 0.0);
    const double closing = n.dot(meeting.approach());
    const double push = spring > 0 ? std::max(spring + damping_ * closing, 0.0) : 0;
    const double limit = coefficient_ * (spring + adhesion.weight);
    const double slack_m = limit > 0 ? limit / tangential_stiffness_ : 0;

    const Vec3 sliding = -meeting.approach() + closing * n;  // velocity of the particle along the tool
    law::Triple<double> slip{slip_m.x(), slip_m.y(), slip_m.z()};
    const law::Triple<double> drag = law::frictionForce<double>(
        friction_, law::Touches(), slack_m, {n.x(), n.y(), n.z()}, {sliding.x(), sliding.y(), sliding.z()}, slip);
    slip_m = {slip.x, slip.y, slip.z};
    Answer answer;
    answer.on_particle_n = (push - adhesion.pull) * n + Vec3(drag.x, drag.y, drag.z);
    if (push > 0) {
      answer.stiffness_n_m = stiffness_ * heldShare(closing, n.dot(meeting.tool_m_s)) * n * n.transpose();
      if (dot(drag, drag) < kSticks * limit * limit) {  // a sticking particle also resists the tool along its surface
        const Vec3 tool_along = meeting.tool_m_s - n.dot(meeting.tool_m_s) * n;
        const double along = tool_along.norm();
        const double held = heldShare(along > 0 ? -sliding.dot(tool_along) / along : 0, along);
        answer.stiffness_n_m += tangential_stiffness_ * held * (Eigen::Matrix3d::Identity() - n * n.transpose());
      }
    }
    return answer;
  }

 private:
  static constexpr double kSticks =
      0.99;  // square of the friction over its limit; what rounding may take from one that slides

  double stiffness_, damping_, coefficient_, reach_m_;  // stiffness_ first: others are made of it
  law::CohesionOf<double> adhesion_;
  double tangential_stiffness_;
  law::FrictionOf<double> friction_;
};

Answer icra2021Answer(const ToolParameters& tool, double radius_m, double dt_s, const Meeting& meeting) noexcept {
  HAPTO_ASSERT(radius_m > 0 && dt_s > 0);
  const double tool_speed = meeting.outward.dot(meeting.tool_m_s);
  const double closing = tool_speed - meeting.outward.dot(meeting.particle_m_s);
  const double push = toolForce(tool, radius_m, dt_s, meeting.depth_m, closing);
  if (push == 0) {
    return {};
  }
  return {push * meeting.outward,
          tool.stiffness_n_m * heldShare(closing, tool_speed) * meeting.outward * meeting.outward.transpose()};
}

/// Two directions along a surface, for each normal of it: those of one surface, turned the shortest way. The normals of
/// a box are nowhere near the one where that is not defined but at one corner.
class Tangents {
 public:
  explicit Tangents(const Vec3& normal)
      : turned_(Quat::FromTwoVectors(Vec3::Constant(1), normal).toRotationMatrix() * alongTheFirst()) {}

  [[nodiscard]] Vec3 along(const Eigen::Vector2d& components) const { return turned_ * components; }
  [[nodiscard]] Eigen::Vector2d of(const Vec3& v) const { return turned_.transpose() * v; }

 private:
  using Columns = Eigen::Matrix<double, 3, 2>;
  static Columns alongTheFirst() {
    Columns columns;
    columns << Vec3(1, -1, 0).normalized(), Vec3(1, 1, -2).normalized();
    return columns;
  }

  Columns turned_;
};

/// Slip of a particle on one of two jaws, tool frame: see ParticleMemory.
Vec3 slipAlong(const Float4& kept, std::size_t jaw, const Vec3& normal) {
  HAPTO_ASSERT(jaw < 2);
  return Tangents(normal).along(jaw == 0 ? Eigen::Vector2d(kept.x, kept.y) : Eigen::Vector2d(kept.z, kept.w));
}
void keepSlip(Float4& kept, std::size_t jaw, const Vec3& normal, const Vec3& slip_m) {
  HAPTO_ASSERT(jaw < 2);
  const Eigen::Vector2f slid = Tangents(normal).of(slip_m).cast<float>();
  (jaw == 0 ? kept.x : kept.z) = slid.x();
  (jaw == 0 ? kept.y : kept.w) = slid.y();
}

/// A tool at one moment, and what it has met so far.
class Encounter {
 public:
  Encounter(const ToolParameters& tool, const Pose& scene_T_tool, const Twist& twist, double opening_m_s,
            const SoilParameters& soil, const GrainClasses& classes, double dt_s)
      : tool_(tool),
        pose_(scene_T_tool),
        twist_(twist),
        opening_m_s_(opening_m_s),
        classes_(classes),
        frictional_(ofEachClass(tool, soil, dt_s)),
        with_stones_(withoutAdhesion(tool), soil, dt_s, 1),
        radius_m_(soil.radius_m),
        dt_s_(dt_s),
        contact_friction_(soil.friction == FrictionModel::kContact),
        contact_m_(contactReach(tool, soil)),
        around_m_(static_cast<float>(contact_m_ + kRounding_m)),
        enclosing_m_(enclosingRadius(tool)),
        reach_m_(enclosing_m_ + contact_m_),
        box_(boxAround(tool, scene_T_tool)),
        rotation_(scene_T_tool.orientation.toRotationMatrix()) {}

  /// Meets those stones that are near, sphere by sphere: to the tool each sphere is a grain that turns with its stone.
  void meet(Stones& stones, ToolMemory& memory) noexcept {
    for (std::size_t i = 0; i < stones.size(); ++i) {
      const Pose pose = stones.pose(i);
      const double near_m = enclosing_m_ + stones.shape(i)->reach_m;
      if ((pose.position_m - pose_.position_m).squaredNorm() < near_m * near_m) {
        meet(stones, i, memory.stone(i));
      }
    }
  }

  /// From the tool's origin to the centre of a particle it may touch.
  [[nodiscard]] double reach() const noexcept { return reach_m_; }

  /// Forces on the particles of one group.
  using Forces = std::array<Float4, kGroup>;

  /// Computes contacts of particles first..last-1, a group or a part of one, and returns whether the tool puts forces
  /// on any. Particles further from the box around the tool than contact reaches are skipped: their contact has ended,
  /// and their memory is cleared.
  bool meet(std::size_t first, std::size_t last, const BedState& state, const ParticleMemory& memory,
            Forces& forces) noexcept {
    HAPTO_ASSERT(first % kGroup == 0 && first < last && last <= first + kGroup);
    HAPTO_ASSERT(last <= state.particles());
    HAPTO_ASSERT(memory.side.size() >= last);
    HAPTO_ASSERT(!contact_friction_ || memory.slip.size() >= last);
    const std::uint32_t near = nearBox(box_, around_m_, state.position.data() + first);
    if (near == 0 && isForgotten(first, last, memory)) {
      return false;
    }
    forces = {};
    bool pushes = false;
    for (std::size_t i = first; i < last; ++i) {
      if ((near >> (i - first) & 1) != 0 && !state.isHeld(i)) {
        const Float4& force = forces[i - first] = meet(i, state, memory);
        pushes = pushes || force.x != 0 || force.y != 0 || force.z != 0;
      } else {
        memory.side[i] = 0;
        if (contact_friction_) {
          memory.slip[i] = {};
        }
      }
    }
    return pushes;
  }

  [[nodiscard]] const ToolReaction& reaction() const noexcept { return reaction_; }

 private:
  /// A tool is to grains of each class what it is to the coarsest, scaled by size as the soil is.
  static std::array<FrictionalTool, GrainClasses::kMost> ofEachClass(const ToolParameters& tool,
                                                                     const SoilParameters& soil, double dt_s) {
    const auto of = [&](int c) { return FrictionalTool(tool, soil, dt_s, GrainClasses::scale(c)); };
    return {of(0), of(1), of(2), of(3)};
  }

  /// Whether the tool remembers nothing of particles first..last-1.
  [[nodiscard]] bool isForgotten(std::size_t first, std::size_t last, const ParticleMemory& memory) const noexcept {
    static constexpr std::array<Float4, kGroup> kNothing{};
    const auto nothing = [&](const auto& kept) {
      return std::memcmp(kept.data() + first, kNothing.data(), (last - first) * sizeof(kept[0])) == 0;
    };
    return nothing(memory.side) && (!contact_friction_ || nothing(memory.slip));
  }

  /// The tool as a bare stone meets it: only soil clings.
  static ToolParameters withoutAdhesion(ToolParameters tool) {
    tool.adhesion_n = 0;
    return tool;
  }

  /// Force on one particle within reach.
  Float4 meet(std::size_t i, const BedState& state, const ParticleMemory& memory) noexcept {
    HAPTO_ASSERT(i < state.particles());
    HAPTO_ASSERT(!state.isHeld(i));
    const Float4& p = state.position[i];
    const Float4& v = state.velocity[i];
    const Grain grain{.lever_m = Vec3(p.x, p.y, p.z) - pose_.position_m,
                      .radius_m = radius_m_ + p.w,
                      .twist = {Vec3(v.x, v.y, v.z), Vec3::Zero()},
                      .law = &frictional_[static_cast<std::size_t>(classes_.of(p.w))]};
    return meet(grain, memory.side[i], contact_friction_ ? &memory.slip[i] : nullptr,
                [](const Answer&, const Vec3&) {});
  }

  /// Forces on one stone.
  void meet(Stones& stones, std::size_t stone, std::span<SphereMemory> memory) noexcept {
    HAPTO_ASSERT(stone < stones.size());
    const Vec3 middle_m = stones.pose(stone).position_m;
    const Twist twist = stones.twist(stone);
    const std::span<const Vec3> centres_m = stones.spheres(stone);
    for (std::size_t s = 0; s < centres_m.size(); ++s) {
      const Grain grain{.lever_m = centres_m[s] - pose_.position_m,
                        .radius_m = stones.shape(stone)->spheres[s].radius_m,
                        .twist = {twist.at(centres_m[s] - middle_m), twist.angular_rad_s},
                        .law = &with_stones_};
      if (grain.lever_m.norm() < enclosing_m_ + grain.radius_m) {
        meet(grain, memory[s].side, &memory[s].slip_m, [&](const Answer& answer, const Vec3& point_m) {
          stones.push(stone, answer.on_particle_n, pose_.position_m + point_m);
        });
      } else {
        memory[s] = {};
      }
    }
  }

  /// A particle, or a sphere of a stone, within reach; its centre from the tool's origin.
  struct Grain {
    Vec3 lever_m;
    double radius_m;
    Twist twist;  ///< twist of its centre
    const FrictionalTool* law;
  };

  /// @param kept  null without contact friction. @param also  is called with each reaction and its place.
  template <class Also>
  Float4 meet(const Grain& grain, std::int8_t& side, Float4* kept, const Also& also) noexcept {
    if (tool_.shape == ToolShape::kJaws) {
      return meetJaws(grain, side, kept, also);
    }
    const Penetration contact = penetration(tool_, rotation_.transpose() * grain.lever_m, grain.radius_m, side);
    side = static_cast<std::int8_t>(contact.side);

    Vec3 slip = Vec3::Zero();
    if (kept != nullptr) {
      slip = rotation_ * Vec3(kept->x, kept->y, kept->z);
    }
    const Touch touch = touchOf(contact, grain);
    const Answer answer = answerTo(touch, twist_.at(touch.point_m), grain, slip);
    if (kept != nullptr) {
      *kept = float4(rotation_.transpose() * slip);
    }
    if (answer.on_particle_n.isZero(0)) {
      return {};
    }
    feel(answer, touch.point_m);
    also(answer, touch.point_m);
    return float4(answer.on_particle_n);
  }

  /// Place and depth of a contact, scene frame.
  struct Touch {
    Vec3 outward, point_m;  ///< on the tool's surface, from its origin
    double depth_m;
  };

  [[nodiscard]] Touch touchOf(const Penetration& contact, const Grain& grain) const noexcept {
    const Vec3 outward = rotation_ * contact.outward;
    return {outward, grain.lever_m - outward * (grain.radius_m - contact.depth_m), contact.depth_m};
  }

  /// @param slip_m  of a soil with contact friction, scene frame; read and written.
  [[nodiscard]] Answer answerTo(const Touch& touch, const Vec3& tool_m_s, const Grain& grain,
                                Vec3& slip_m) const noexcept {
    const Meeting meeting{touch.outward, touch.depth_m, tool_m_s, grain.twist.at(touch.point_m - grain.lever_m)};
    return contact_friction_ ? grain.law->meet(meeting, slip_m) : icra2021Answer(tool_, radius_m_, dt_s_, meeting);
  }

  void feel(const Answer& answer, const Vec3& point_m) noexcept {
    reaction_.wrench.add(-answer.on_particle_n, point_m);
    reaction_.stiffness_n_m += answer.stiffness_n_m;
  }

  /// As above with both jaws, each of which moves independently. @param kept  null without contact friction.
  template <class Also>
  Float4 meetJaws(const Grain& grain, std::int8_t& sides, Float4* kept, const Also& also) noexcept {
    const JawContacts contacts = jawContacts(tool_, rotation_.transpose() * grain.lever_m, grain.radius_m, sides);
    sides = contacts.sides;
    Vec3 on_particle_n = Vec3::Zero();
    for (std::size_t i = 0; i < 2; ++i) {
      const JawContact& jaw = contacts.jaws[i];
      const Touch touch = touchOf(jaw.found, grain);
      const Vec3 away = (i == 0 ? -0.5 : 0.5) * rotation_.col(0);  // its velocity per opening speed of the jaws
      Vec3 slip = Vec3::Zero();
      if (kept != nullptr) {
        slip = rotation_ * slipAlong(*kept, i, jaw.found.outward);
      }
      Answer answer = answerTo(touch, twist_.at(touch.point_m) + opening_m_s_ * away, grain, slip);
      if (kept != nullptr) {
        keepSlip(*kept, i, jaw.found.outward, rotation_.transpose() * slip);
      }
      answer.on_particle_n *= jaw.share;
      answer.stiffness_n_m *= jaw.share;
      feel(answer, touch.point_m);
      also(answer, touch.point_m);
      reaction_.grip_n -= answer.on_particle_n.dot(away);
      on_particle_n += answer.on_particle_n;
    }
    return float4(on_particle_n);
  }

  const ToolParameters& tool_;
  const Pose& pose_;
  const Twist& twist_;
  double opening_m_s_;
  const GrainClasses& classes_;
  std::array<FrictionalTool, GrainClasses::kMost> frictional_;
  FrictionalTool with_stones_;
  double radius_m_, dt_s_;
  bool contact_friction_;
  static constexpr double kRounding_m = 2e-6;  // rounding of the box's test, in single precision
  double contact_m_;                           // from the tool's surface to the centre of a particle that feels it
  float around_m_;
  double enclosing_m_, reach_m_;
  ToolBox box_;
  Eigen::Matrix3d rotation_;
  ToolReaction reaction_;
};

}  // namespace

ToolReaction applyToolContact(const ToolParameters& tool, const Pose& scene_T_tool, const Twist& twist,
                              const SoilParameters& soil, double dt_s, const BedState& state,
                              const ParticleMemory& memory, std::vector<Float4>& forces, double opening_m_s) noexcept {
  const GrainClasses alike(soil.radius_m);
  Encounter encounter(tool, scene_T_tool, twist, opening_m_s, soil, alike, dt_s);
  for (std::size_t first = 0; first < state.particles(); first += kGroup) {
    const std::size_t last = std::min(first + kGroup, state.particles());
    Encounter::Forces on_group{};
    (void)encounter.meet(first, last, state, memory, on_group);
    std::copy_n(on_group.begin(), last - first, forces.begin() + static_cast<std::ptrdiff_t>(first));
  }
  return encounter.reaction();
}

ToolReaction applyToolContact(const ToolParameters& tool, const Pose& scene_T_tool, const Twist& twist, double dt_s,
                              Bed& bed, ToolMemory& memory, double opening_m_s) noexcept {
  Encounter encounter(tool, scene_T_tool, twist, opening_m_s, bed.parameters().soil, bed.classes(), dt_s);
  const ParticleMemory particles = memory.particles();
  for (const std::uint32_t group : bed.groupsNear(memory.nearGroups(), scene_T_tool.position_m, encounter.reach())) {
    const std::size_t first = group * kGroup;
    Encounter::Forces forces;
    if (encounter.meet(first, std::min(first + kGroup, bed.particles()), bed.state(), particles, forces)) {
      bed.push(group, forces);
    }
  }
  encounter.meet(bed.stones(), memory);
  return encounter.reaction();
}

}  // namespace haptolith

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/grain_classes.h"
#include "haptolith/bed/kernel/stone_kernel.h"
#include "haptolith/bed/neighbourhood.h"
#include "haptolith/bed/stone_contact.h"
#include "haptolith/bed/stones_state.h"
#include "haptolith/bed/wakefulness.h"
#include "haptolith/core/vec.h"
#include "haptolith/stone/stone_shape.h"

namespace haptolith {

/// The soil around stones, as a step finds it.
struct SoilAroundStones {
  BedState& state;
  std::vector<Float4>& forces;  ///< on particles, N: others' so far, to which those of the stones come
  const Neighbourhood& neighbourhood;
  Wakefulness& wakefulness;
};

/// Rigid stones in a bed, each a clump of spheres: they move and turn by what soil, walls, each other and tools do to
/// them.
///
/// A stone touches soil as a very large grain would. Between bodies of radii r1 and r2 there is the law of two grains
/// of R = 2 r1 r2 / (r1 + r2), damped as two of the mass 2 m1 m2 / (m1 + m2), as between grain classes
/// (contactFrictionLaw()); a stone's r is that of the sphere of its volume, and a wall is its mirror image. A particle
/// touches a stone at the one sphere that it is deepest in: so the spheres' union is the stone, with one contact's
/// stiffness everywhere. Each sphere of a stone touches walls, tools and, at the deepest of its spheres, another stone.
///
/// Each contact puts exactly opposite forces on both sides, at one point: among stones momentum and angular momentum
/// are kept to rounding. Particles do not turn, so what friction would turn them by stays with the stone alone.
///
/// A stone sleeps when all soil around it does and it has not moved for as long as that takes; it wakes with any of it.
class Stones {
 public:
  Stones() = default;

  /// @param shapes  one for each stone. @param fixed  which of them stay where they are.
  Stones(const BedParameters& bed, double skin_m, std::vector<std::shared_ptr<const StoneShape>> shapes,
         const std::vector<bool>& fixed);

  [[nodiscard]] std::size_t size() const noexcept { return shapes_.size(); }
  /// Never changes while the bed lives. Not for the tick.
  [[nodiscard]] const std::shared_ptr<const StoneShape>& shape(std::size_t stone) const { return shapes_[stone]; }
  /// scene_T_stone. May be called in the tick.
  [[nodiscard]] Pose pose(std::size_t stone) const noexcept;
  /// Poses of all stones. Not for the tick.
  [[nodiscard]] std::vector<Pose> poses() const;
  /// Twist of a stone's centre of mass, scene frame.
  [[nodiscard]] Twist twist(std::size_t stone) const noexcept;
  [[nodiscard]] double mass(std::size_t stone) const noexcept { return bodies_[stone].mass_kg; }
  /// Principal moments of inertia, in kg m^2.
  [[nodiscard]] Vec3 inertia(std::size_t stone) const noexcept { return bodies_[stone].inertia_kg_m2; }
  [[nodiscard]] bool isFixed(std::size_t stone) const noexcept { return bodies_[stone].fixed; }
  [[nodiscard]] bool asleep(std::size_t stone) const noexcept { return state_.stones[stone].asleep(); }
  [[nodiscard]] const StonesState& state() const noexcept { return state_; }
  /// Current centres of its spheres, scene frame.
  [[nodiscard]] std::span<const Vec3> spheres(std::size_t stone) const noexcept { return bodies_[stone].centres_m; }

  /// Puts a stone somewhere, at rest or moving. May be called in the tick.
  void place(std::size_t stone, const Pose& scene_T_stone, const Twist& twist = {}) noexcept;

  /// A force of others (a tool) on a stone for the next step, in N, scene frame, at a point of the scene; wakes it. May
  /// be called in the tick.
  void push(std::size_t stone, const Vec3& force_n, const Vec3& point_m) noexcept;

  /// While stones grow into soil: for it their spheres are smaller by so much, and they stand fast until that is 0.
  void growIn(double short_m) noexcept;

  /// First part of a step of `dt_s`: what soil and walls do to stones where they all are now, in `parts` that several
  /// threads may work out at once.
  void begin(double dt_s) noexcept;
  [[nodiscard]] int parts() const noexcept;
  void press(const SoilAroundStones& soil, int part, int parts) noexcept;
  /// Second part, when all have come back: what stones do to each other, and all of them to the soil. False when there
  /// is no room for all that touches a stone: the bed has collapsed.
  [[nodiscard]] bool putForces(const SoilAroundStones& soil) noexcept;
  /// Third part, when the soil has felt them: takes the stones' forces on it back; those of others stay.
  void takeBackForces(std::vector<Float4>& forces) noexcept;
  /// Last part: velocities, then places.
  void move(const Vec3& gravity_m_s2, double dt_s, const RestRule& rest) noexcept;
  /// No particle has gone further than this in the step: who is near is looked for again when it might have changed.
  void soilMoved(double distance_m) noexcept { went_m_ += distance_m; }

  /// Sets another soil; all stones wake. May be called in the tick.
  void setSoil(const SoilParameters& soil) noexcept;
  void wakeAll() noexcept;
  /// Soil has been put elsewhere: in the next step all look for who is near.
  void lookAgain() noexcept;
  /// False when a stone is nowhere.
  [[nodiscard]] bool areFinite() const noexcept;
  /// Stops them where they are.
  void stop() noexcept;
  /// Slows down those that would go or turn further in a step than it resolves, a fifth of their radius or of a radian:
  /// what soil that is pressed together throws out while it makes room for them.
  void slowDown(double dt_s) noexcept;

  /// Kinetic plus gravitational plus contact energy of the stones in J, that of their contacts with soil and stretched
  /// friction included. Not for the tick.
  [[nodiscard]] double energy(const BedState& soil, const Vec3& gravity_m_s2) const;

  /// Largest speed of any point of a stone that is not fixed, in m/s; may be more than is reached.
  [[nodiscard]] double largestSpeed() const noexcept;

  /// Largest depth of a sphere at a place in any stone; <= 0 outside of all. Checks all
  /// spheres: in the tick once at most.
  [[nodiscard]] double depthOf(const Vec3& centre_m, double radius_m) const;

  [[nodiscard]] StonesState save() const;
  /// @throws InvalidParameter when it has other stones than these or soil of more particles, or holds NaN.
  void requireSound(const StonesState& saved, std::size_t particles) const;
  /// Continues from a state that has been checked.
  void restore(const StonesState& saved);
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Body {
    double mass_kg = 0, inverse_mass = 0;  ///< the inverse is 0 if fixed
    Vec3 inertia_kg_m2 = Vec3::Zero(), inverse_inertia = Vec3::Zero();
    double radius_m = 0;  ///< radius of the sphere of equal volume
    bool fixed = false;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< scene_R_stone
    Vec3 angular_rad_s = Vec3::Zero();
    std::vector<Vec3> centres_m;  ///< centres of its spheres, scene frame
    Wrench contact, pushed;  ///< about its centre, scene frame: contacts of this step; other forces, for the next step
  };

  /// Friction's stretch that a particle had when who is near was looked for the last time, stone's frame.
  struct Slid {
    std::uint32_t particle;
    Stretch stretch_m;
  };
  /// Another stone that a sphere may touch.
  struct NearStone {
    std::uint32_t pair;            ///< in Memory::pairs
    std::uint32_t sphere;          ///< sphere of this stone
    std::array<float, 3> stretch;  ///< scene frame
  };
  struct Pair {
    std::uint32_t stone;  ///< after this one in order
    StoneContactLaw law;
  };
  /// Force of a stone on a particle in this step.
  struct Push {
    std::uint32_t particle;
    Stretch force_n;
  };
  struct Memory {
    std::vector<StonePack> packs;           ///< particles that may touch it before the next rebuild
    std::vector<std::uint16_t> spheres;     ///< numbers that the packs refer to
    std::vector<std::uint32_t> candidates;  ///< room for looking: particles
    std::vector<std::uint64_t> near_now;    ///< and a bit for each sphere
    std::vector<Slid> before;               ///< slips of a saved state until the first rebuild, and room for them
    std::vector<std::uint32_t> groups;      ///< groups of the particles, each once
    std::vector<Pair> pairs;
    std::vector<NearStone> stones, stones_before;
    std::vector<std::array<std::array<float, 3>, 3>> walls;  ///< slip of each sphere on the floor, an x and a y wall
    std::vector<Push> pushes;
    bool has_room = true;        ///< for all that is near
    double looked_at_m = 0;      ///< total movement at the last rebuild
    bool look = true;            ///< whether it has to be at once
    bool beside_unrest = true;   ///< whether soil around it is awake, or a stone that it touches moves
    bool touched_walls = false;  ///< whether `walls` remembers anything
  };

  [[nodiscard]] bool lookAround(std::size_t stone, const SoilAroundStones& soil) noexcept;
  [[nodiscard]] bool lookForParticles(std::size_t stone, const SoilAroundStones& soil) noexcept;
  void listCandidates(std::size_t stone, const SoilAroundStones& soil) noexcept;
  [[nodiscard]] bool packUp(std::size_t stone, const BedState& soil) noexcept;
  [[nodiscard]] bool lookForStones(std::size_t stone) noexcept;
  [[nodiscard]] double margin() const noexcept;
  void pressSoil(std::size_t stone, const SoilAroundStones& soil) noexcept;
  void pressWalls(std::size_t stone) noexcept;
  void pressStones(std::size_t stone, const SoilAroundStones& soil) noexcept;
  void wakeBesideAnother(std::size_t stone, const SoilAroundStones& soil) noexcept;
  void turn(std::size_t stone, double dt_s) noexcept;
  void noteTurn(std::size_t stone) noexcept;
  void rest(std::size_t stone, const RestRule& rule) noexcept;
  void wake(std::size_t stone) noexcept;
  [[nodiscard]] Vec3 velocityAt(std::size_t stone, const Vec3& lever_m) const noexcept {
    return state_.stones[stone].velocity_m_s + bodies_[stone].angular_rad_s.cross(lever_m);
  }
  void makeLaws() noexcept;

  SoilParameters soil_;
  GrainClasses classes_;
  double density_kg_m3_ = 0;
  double half_width_m_ = 0, half_length_m_ = 0, wall_ratio_ = 1;
  double skin_m_ = 0;
  std::uint16_t rest_steps_ = 0;  ///< RestRule::steps
  std::vector<std::shared_ptr<const StoneShape>> shapes_;
  std::vector<std::vector<Float4>> spheres_;  ///< spheres of the shapes: centre in the stone frame, radius
  std::vector<Body> bodies_;
  StonesState state_;  ///< its list of slips is filled by save() alone
  std::vector<Memory> memory_;
  struct SoilLaw {
    StoneContactLaw law;
    ContactFrictionLaw in_kernel;  ///< that law for the kernel
  };
  std::vector<std::array<SoilLaw, GrainClasses::kMost>> with_soil_;
  std::vector<StoneContactLaw> with_walls_, with_floor_;
  /// Forces that stones have added to particles in this step, and the forces before.
  struct Put {
    std::uint32_t particle;
    Float4 before;
  };
  std::vector<Put> put_;
  double went_m_ = 0;   ///< that no two bodies can have come closer by, in all
  double dt_s_ = 0;     ///< duration of the current step
  double short_m_ = 0;  ///< growIn()
};

}  // namespace haptolith

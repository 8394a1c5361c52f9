#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/kernel/soil_laws.h"
#include "haptolith/bed/kernel/step_kernel.h"
#include "haptolith/bed/near_groups.h"
#include "haptolith/bed/neighbourhood.h"
#include "haptolith/bed/start/bed_tile.h"
#include "haptolith/bed/stones.h"
#include "haptolith/bed/wakefulness.h"
#include "haptolith/core/process/worker_team.h"

namespace haptolith {

/// Result of a step. Any value but kOk means that the state can no longer be trusted.
enum class StepStatus { kOk, kNotFinite, kCollapsed };

[[nodiscard]] const char* text(StepStatus status) noexcept;

/// Called now and then while a bed settles, with simulated time and the largest speed; false gives up.
using SettleProgress = std::function<bool(double time_s, double speed_m_s)>;

/// Soil and stones as they lie in a bed: what it takes to make another bed of them.
struct LyingSoil {
  std::vector<Float4> grains;  ///< centres, m; w: by how much a grain's radius exceeds the soil's
  std::size_t held = 0;        ///< number of fixed particles, the last ones, outside the sides of a settled bed
  std::vector<Pose> stones;    ///< scene_T_stone
};

/// A grain that is to lie somewhere else, scene frame.
struct GrainMove {
  std::size_t grain = 0;
  Vec3 from_m = Vec3::Zero(), to_m = Vec3::Zero();
  [[nodiscard]] bool operator==(const GrainMove&) const = default;
};

/// A box of identical macroparticles: their contacts, friction and gravity. With ICRA 2021 friction contacts follow
/// (paper 19), friction (14) and damping (20); with contact friction see friction-inl.h.
///
/// After construction nothing allocates. Equal parameters, start and forces give equal bits for any number of
/// threads, on every machine with the same arithmetic (simd_target.h).
class Bed {
 public:
  /// Makes the bed's first state according to `parameters.start` (see bed_start.h and bed_tile.h); settling reports to
  /// `progress`.
  /// @throws InvalidParameter when the parameters are not valid or the particles do not fit; Failure as settle().
  explicit Bed(const BedParameters& parameters, const SettleProgress& progress = {});

  /// A bed with its centres where the caller wants them, at rest; how large each grain is, the seed decides. Stones are
  /// where `stones` has them, by scene_T_stone; without it where the parameters put them.
  Bed(const BedParameters& parameters, const std::vector<Vec3>& centres_m, const std::vector<Pose>& stones = {});

  /// As above with each particle's size: w is the excess of its radius over the soil's. In a graded bed the particles
  /// form complete groups of 16 of one class, except the last group.
  Bed(const BedParameters& parameters, const std::vector<Float4>& grains, const std::vector<Pose>& stones = {});

  /// As above from soil of a bed with such parameters; its held particles are held again. The friction memory of
  /// contacts is cleared.
  Bed(const BedParameters& parameters, const LyingSoil& lying);

  /// Continues a saved bed of the same parameters bit for bit, without settling again. Soil and gravity may have
  /// changed since the bed was made: `parameters` holds their values at the time of saving.
  /// @throws InvalidParameter as restore().
  Bed(const BedParameters& parameters, const SavedBed& saved);

  /// Forces of others on particles, in N, scene frame; one per particle. Those written here last until they are
  /// overwritten; those of push() are among them until the step after. They count as load, not as contact between
  /// macroparticles: they raise no friction (paper 14). Soil that sleeps does not feel them: wake() it, or ask
  /// groupsNear(), which does.
  [[nodiscard]] std::vector<Float4>& externalForces() noexcept { return external_; }

  /// Adds a tool's forces on a group's particles, in N, scene frame, for the next step alone. May be called in the
  /// tick.
  void push(std::uint32_t group, const std::array<Float4, kGroup>& forces_n) noexcept;

  /// For groupsNear(): one for each tool. Not for the tick.
  [[nodiscard]] NearGroups nearGroups() const { return NearGroups(state_.rested.size()); }
  /// Groups of particles of which some may lie within `radius_m` of a point, and those near that tool the time before,
  /// in ascending order: who remembers what is near a tool forgets what it has left. Valid until the tool's next call.
  /// All of them are woken, and those near stay awake in the next step. May be called in the tick.
  [[nodiscard]] std::span<const std::uint32_t> groupsNear(NearGroups& near, const Vec3& centre_m,
                                                          double radius_m) noexcept;

  /// One semi-implicit step of `dt_s`: forces at the present positions, velocities, then positions. May be called in
  /// the tick. `dt_s` must be a stable step: see substepsFor() in critical_step.h.
  [[nodiscard]] StepStatus step(double dt_s) noexcept;

  /// Whether a step is now worth the help of other threads.
  [[nodiscard]] bool sharesSteps() const noexcept;
  /// Announces a step within this time: the other threads wake up and poll for it. May be called in the tick's thread,
  /// between ticks.
  void expectStep(std::int64_t within_ns) noexcept { team_.expect(within_ns); }
  /// Sets the scheduling of the other threads. May be called in the tick.
  void scheduleHelpers(const HelperSchedule& schedule) noexcept { team_.schedule(schedule); }

  /// From the next step on a particle moves with this velocity, whatever pushes it, and others feel it as before: rough
  /// plates and floors are made of such particles. None that is held can be driven. May be called in the tick.
  void drive(std::size_t particle, const Vec3& velocity_m_s) noexcept;

  /// Wakes a particle and what is next to it. May be called in the tick.
  void wake(std::size_t particle) noexcept { wakefulness_.wakeAround(particle, state_); }

  /// Puts a particle somewhere else, at rest. Its neighbours are found by the end of the next step, so it must touch
  /// none there. May be called in the tick.
  void place(std::size_t particle, const Vec3& position_m) noexcept;

  /// Puts a grain somewhere else, at rest, if the state is as the caller has seen it: the particle is free and within a
  /// tenth of R of where it was, and in its new place it touches neither grains nor stones nor walls. False, and it
  /// stays, otherwise. May be called in the tick.
  [[nodiscard]] bool moveGrain(const GrainMove& move) noexcept;

  /// Lets a driven particle go.
  void release(std::size_t particle) noexcept;

  /// Whether friction and cohesion are switched off and falling soil slowed down, for a dense bed that settles
  /// soon. With a tool in it settle() cannot be used; this can.
  void setSettling(bool settling) noexcept;

  /// Gravity from the next step on, in m/s^2, scene frame: a laboratory loads its specimens without their weight.
  void setGravity(const Vec3& gravity_m_s2) noexcept;

  /// Another soil from the next step on, its particles lying as they lie; `laws.soil` must be one that the bed
  /// isCompatible(). May be called in the tick.
  void setSoil(const SoilLaws& laws) noexcept;

  /// Sets a soil with equal contact range and slightly different friction and cohesion. Sleeping particles stay asleep
  /// and have the new laws when they wake. May be called in the tick.
  void adjustSoil(const SoilLaws& laws) noexcept;

  /// Whether nothing can push a particle: driven ones, and soil that is held where a box of settled soil ends.
  [[nodiscard]] bool isDriven(std::size_t particle) const noexcept { return state_.velocity[particle].w != 0; }
  /// Number of held particles, see LaidSoil; they exert no force on the tool.
  [[nodiscard]] std::size_t heldParticles() const noexcept;
  /// Not for the tick.
  [[nodiscard]] LyingSoil lying() const;

  /// Force of its neighbours on a particle, in N, scene frame: in the last step in which it was awake and any particle
  /// was driven.
  [[nodiscard]] Vec3 contactForce(std::size_t particle) const noexcept;

  /// Lets the particles fall and settle without friction, then stops them and sets the step count
  /// to 0. Not for the tick.
  /// @throws Failure when the bed does not settle within `longest_s` of simulated time, or `progress` gives up.
  void settle(double dt_s, double longest_s, const SettleProgress& progress = {});

  /// Kinetic plus gravitational plus contact energy, that of stretched friction included, in J; gravity's zero is the
  /// origin. Not for the tick.
  [[nodiscard]] double energy() const;

  /// Largest speed of any particle, or of particles first..last-1, driven ones aside, in m/s.
  [[nodiscard]] double largestSpeed() const noexcept { return largestSpeed(0, particles()); }
  [[nodiscard]] double largestSpeed(std::size_t first, std::size_t last) const noexcept;

  /// Height of the highest point of any particle above the floor, in m.
  [[nodiscard]] double surfaceHeight() const noexcept;

  [[nodiscard]] std::size_t particles() const noexcept { return state_.particles(); }
  /// Number of particles that the last step left awake, in complete groups: see Wakefulness.
  [[nodiscard]] std::size_t awake() const noexcept {
    return std::min(particles(), wakefulness_.awake().size() * kGroup);
  }
  [[nodiscard]] const BedParameters& parameters() const noexcept { return parameters_; }
  [[nodiscard]] const ContactLaw& law() const noexcept { return laws_.pair; }
  /// Mass of a particle of the soil's own radius, kg.
  [[nodiscard]] double mass() const noexcept { return laws_.mass_kg; }
  /// Sizes of grain, and which a particle is of.
  [[nodiscard]] const GrainClasses& classes() const noexcept { return laws_.graded.classes; }
  [[nodiscard]] int classOf(std::size_t particle) const noexcept { return classes().of(state_.position[particle].w); }
  /// Run lengths of particle classes, from the first particle on. They never change, so threads other than the tick's
  /// may also read them. Not for the tick.
  struct GrainRun {
    int grain_class;
    std::size_t count;
  };
  [[nodiscard]] std::vector<GrainRun> grainRuns() const;
  [[nodiscard]] const BedState& state() const noexcept { return state_; }
  /// Number of changes so far: of steps and restored states. A group has been stepped or restored since the change
  /// that changes() counted if its changed() is greater. May be called in the tick.
  [[nodiscard]] std::uint64_t changes() const noexcept { return changes_; }
  [[nodiscard]] std::uint64_t changed(std::size_t group) const noexcept { return changed_[group]; }
  [[nodiscard]] const Stones& stones() const noexcept { return stones_; }
  [[nodiscard]] Stones& stones() noexcept { return stones_; }
  /// As stateHash(), with the stones. May be called in the tick.
  [[nodiscard]] std::uint64_t hash(std::span<const ToolTrace> tools = {}, std::size_t part = 0,
                                   std::size_t parts = 1) const noexcept;
  /// Number of particles whose neighbour lists were rebuilt because they had moved: see Neighbourhood.
  [[nodiscard]] std::uint64_t listRebuilds() const noexcept { return list_rebuilds_; }
  /// Time that took since the last call, in us. May be called in the tick.
  [[nodiscard]] double takeListRebuildUs() noexcept;
  /// Bytes of memory in use for the particles, all arrays together.
  [[nodiscard]] std::size_t bytes() const noexcept;

  /// Returns everything that a bed needs to continue from here, in this bed or another. Not for the tick.
  [[nodiscard]] SavedBed save() const;
  /// Continues from `state` bit for bit. Not for the tick. @throws InvalidParameter when it has another number of
  /// particles, holds NaN or infinity, or has collapsed; the bed is then as it was.
  void restore(const BedState& state);
  /// As above, with the stones.
  void restore(const SavedBed& saved);

 private:
  Bed(const BedParameters& parameters, const std::vector<Float4>& grains, double grid_height_m);
  void noteClasses();
  /// Initial particles of a bed, and the source of their contact memory.
  struct StartingSoil {
    BedTile tile;
    LaidSoil laid;
  };
  Bed(const BedParameters& parameters, const StartingSoil& soil, const SettleProgress& progress);
  [[nodiscard]] static StartingSoil startingSoil(const BedParameters& bed, const SettleProgress& progress);
  /// Particles of several sizes that have settled together, next to coarse ones that are held.
  [[nodiscard]] static LaidSoil gradedSoil(const BedParameters& bed, const SettleProgress& progress);
  /// Takes over what the contacts of laid soil remember.
  void recall(const StartingSoil& soil) noexcept;
  /// Fixes the particles from free_particles on; the others are as in their tile and may sleep.
  void holdSides(std::size_t free_particles) noexcept;
  /// Makes the stones of the parameters, all at the origin of the scene.
  void makeStones();
  /// Puts them where they are said to be or, of none, where the parameters have them.
  void placeStones(const std::vector<Pose>& places);
  /// Puts soil that is where stones are on top of the rest, and lets both find their hold.
  void bedStones(const SettleProgress& progress);
  void moveOutOfStones();
  [[nodiscard]] bool pressStones(double dt_s) noexcept;
  /// Lets soil find its hold where it lies, until nothing in it moves faster, then stops it where it is.
  void findHold(double dt_s, double rest_m_s, const SettleProgress& progress);
  void stop() noexcept;
  [[nodiscard]] StepConstants constantsFor(double dt_s) const noexcept;
  void takeBackPushes() noexcept;
  [[nodiscard]] bool hasRoomFor(std::size_t particle, const Vec3& place_m) const noexcept;
  void stepPart(int part, int parts) noexcept;
  [[nodiscard]] std::span<const Moved> movedOfParts() const noexcept {
    return {moved_of_part_.data(), static_cast<std::size_t>(parts_)};
  }
  [[nodiscard]] bool rebuildListsOfMoved() noexcept;
  void pruneIfMovedFar(double dt_s) noexcept;
  void wakeAndLetSleep() noexcept;
  [[nodiscard]] bool hasContactFriction() const noexcept {
    return parameters_.soil.friction == FrictionModel::kContact;
  }

  BedParameters parameters_;
  SoilLaws laws_;
  StepBox box_;
  float skin_m_;

  BedState state_;
  Stones stones_;
  std::vector<Float4> next_position_, next_velocity_;
  std::vector<Float4> external_;
  std::vector<Float4> contact_force_;
  std::vector<std::uint8_t> near_walls_;   ///< see StepArrays
  std::vector<std::uint8_t> grain_class_;  ///< class of each group; empty if all particles have one size
  Neighbourhood neighbourhood_;
  double grid_height_m_;
  Wakefulness wakefulness_;
  std::vector<Wakefulness::Transitions> transitions_by_part_;
  std::vector<std::uint64_t> keep_awake_;  ///< a bit for each group that must not sleep in the next step
  std::vector<std::uint32_t> pushed_;      ///< groups that push() put forces on,
  std::vector<std::uint8_t> is_pushed_;    ///< and whether a group is one
  bool pushes_felt_ = false;               ///< whether a step has felt them
  std::vector<std::int32_t>
      moved_;  ///< particles that left their list position in this step: each part's from its first particle on
  std::vector<std::uint64_t> changed_;  ///< value of changes_ at the last change of each group
  std::uint64_t changes_ = 0;
  WorkerTeam team_;
  int parts_ = 1;  ///< that the present step is shared out in
  std::vector<Moved> moved_of_part_;
  std::uint64_t pruning_pass_ = 1;    ///< the present one at who is near, see InnerRows
  double moved_since_pruning_m_ = 0;  ///< that no particle can have gone further
  StepConstants now_{};
  bool friction_on_ = true;
  bool laying_ = false;     ///< findHold(), in which a drag brakes soil
  std::size_t driven_ = 0;  ///< particles
  std::uint64_t list_rebuilds_ = 0;
  std::int64_t rebuilding_ns_ = 0;
};

}  // namespace haptolith

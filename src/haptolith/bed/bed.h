#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/contact_kernel.h"
#include "haptolith/bed/neighbour_list.h"
#include "haptolith/bed/worker_team.h"

namespace haptolith {

/// How a step ended. Anything but kOk means that the state can no longer be trusted.
enum class StepStatus { kOk, kNotFinite, kCollapsed };

[[nodiscard]] const char* text(StepStatus status) noexcept;

/// A box of identical macroparticles: their contacts (paper 19), friction (14), damping (20) and gravity.
///
/// After construction nothing allocates. The same parameters, start and forces give the same bits for any number of
/// threads, on machines with the same instruction set.
class Bed {
 public:
  /// Makes the bed's first state as `parameters.start` asks (see bed_start.h).
  /// @throws InvalidParameter when the parameters are not valid or the particles do not fit.
  explicit Bed(const BedParameters& parameters);

  /// A bed with its centres where the caller wants them, at rest.
  Bed(const BedParameters& parameters, const std::vector<Vec3>& centres_m);

  /// Forces that others (the tool) put on particles for the next step, in N, scene frame; one per particle.
  /// They count as load, not as contact between macroparticles: they raise no friction (paper 14).
  [[nodiscard]] std::vector<Float4>& externalForces() noexcept { return external_; }

  /// One semi-implicit step of `dt_s`: forces at the present positions, velocities, then positions. May be called in
  /// the tick. `dt_s` must be a stable step: see substepsFor() in critical_step.h.
  [[nodiscard]] StepStatus step(double dt_s) noexcept;

  /// Lets the particles fall and come to rest without friction, then stops them where they are and sets the step count
  /// to 0. Not for the tick.
  /// @param progress  called now and then with the largest speed in m/s; return false to stop early. May be empty.
  /// @throws Failure when the bed does not come to rest within `longest_s` of simulated time.
  void settle(double dt_s, double longest_s, const std::function<bool(double speed_m_s)>& progress = {});

  /// Kinetic plus gravitational plus contact energy, in J; gravity's zero is the origin. Not for the tick.
  [[nodiscard]] double energy() const;

  /// Largest speed of any particle, in m/s.
  [[nodiscard]] double largestSpeed() const noexcept;

  /// Height of the highest point of any particle above the floor, in m.
  [[nodiscard]] double surfaceHeight() const noexcept;

  [[nodiscard]] std::size_t particles() const noexcept { return state_.particles(); }
  [[nodiscard]] const BedParameters& parameters() const noexcept { return parameters_; }
  [[nodiscard]] const ContactLaw& law() const noexcept { return law_; }
  [[nodiscard]] double mass() const noexcept { return mass_kg_; }
  [[nodiscard]] const BedState& state() const noexcept { return state_; }
  [[nodiscard]] std::vector<std::int8_t>& toolSides() noexcept { return state_.tool_side; }
  [[nodiscard]] std::uint64_t rebuilds() const noexcept { return rebuilds_; }

  /// Goes on from `state` bit for bit. Not for the tick. @throws InvalidParameter when it has another number of
  /// particles, holds what is no number, or has collapsed; the bed is then as it was.
  void restore(const BedState& state);

 private:
  /// Constants of one step, in the particles' precision.
  struct StepConstants {
    float dt, weight_x, weight_y, weight_z, inverse_mass, damping, static_friction, moving_friction, skin_half_squared;
  };
  struct Part {
    bool moved_far = false;
    bool finite = true;
  };

  [[nodiscard]] StepConstants constantsFor(double dt_s) const noexcept;
  [[nodiscard]] bool rebuildNeighbours() noexcept;
  void advancePart(int part, int parts) noexcept;
  void advance(std::size_t i) noexcept;

  BedParameters parameters_;
  ContactLaw law_, wall_law_;
  KernelLaw kernel_law_;
  double mass_kg_;
  float skin_m_;

  BedState state_;
  std::vector<Float4> next_position_;
  std::vector<Float4> external_;
  std::vector<ContactSum> sums_;
  NeighbourList neighbours_;
  WorkerTeam team_;
  std::vector<Part> part_results_;
  StepConstants now_{};
  bool friction_on_ = true;
  std::uint64_t rebuilds_ = 0;
};

}  // namespace haptolith

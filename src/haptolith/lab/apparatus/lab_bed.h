#pragma once

#include <optional>
#include <span>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/tool/tool_contact.h"

namespace haptolith {

/// Preparation of the soil in the box.
enum class Preparation {
  kDense,   ///< as if shaken: has a peak strength
  kMedium,  ///< as if poured and tapped once: between the other two
  kLoose,   ///< as if poured: has no peak, its strength only grows
};

/// Zero of depth. Particles are large, and their tips are higher than the surface of the soil that they represent.
enum class DepthFrom {
  kTips,     ///< first contact of a plate; for other tools the height below which 98 % of the particles have their tops
  kSurface,  ///< surface of an equivalent soil of uniform density: LabBed::levelSurface()
};

/// Box of a test. Axes as in BedParameters.
struct LabBox {
  double width_m = 0.2, length_m = 0.2;
  bool periodic_x = false, periodic_y = false;
  double wall_friction_ratio = 0;  ///< side-wall friction over the soil's; low, so that walls represent more soil
};

/// Returns about `particles` centres for loose soil above `bottom_m`, lowest first, at random on a grid without
/// contacts. `inside` is true where there may be soil. For loose settling every other layer is over the gaps of the one
/// below: particles do not rotate, so with friction a straight column of them would not fall.
[[nodiscard]] std::vector<Vec3> looseSoil(const SoilParameters& soil, const LabBox& box, std::size_t particles,
                                          double bottom_m, std::uint64_t seed,
                                          const std::function<bool(const Vec3&)>& inside = {},
                                          Preparation preparation = Preparation::kDense);

/// Returns soil with particles of `classes` sizes (GrainClasses), mixed at random, with equal volume per class. Each
/// position of `loose` gets one particle of the coarsest class, or eight of half its radius, and so on. Each class
/// fills entire groups.
[[nodiscard]] std::vector<Float4> mixedGrains(const SoilParameters& soil, const std::vector<Vec3>& loose, int classes,
                                              std::uint64_t seed);

/// Returns the number of particles that fill `volume_m3` when densely packed without load. @throws InvalidParameter for
/// more than three million.
[[nodiscard]] std::size_t particlesFor(const SoilParameters& soil, double volume_m3);

/// Returns the centres of a rough, tight plate over the entire box: closer together than a particle diameter, at random
/// heights of +-0.6 R around `height_m`.
[[nodiscard]] std::vector<Vec3> roughPlate(const SoilParameters& soil, const LabBox& box, double height_m,
                                           std::uint64_t seed);

/// Box with soil, bodies made of driven particles (rough plates, floors) and a tool on a prescribed path. Every test is
/// built of one. Its time steps are somewhat shorter than those of an interactive bed, and not tied to ticks of 1 ms.
class LabBed {
 public:
  /// @param bodies  centres of the particles of each body; bodies are at rest until moveBody().
  /// @throws InvalidParameter as Bed, and when a step would have to be shorter than 1 us.
  LabBed(const LabConditions& conditions, const LabBox& box, const std::vector<Vec3>& soil_m,
         const std::vector<std::vector<Vec3>>& bodies_m = {}, const std::optional<ToolParameters>& tool = {});

  /// As above, with particles of one or more classes, each with its size; bodies are of class 0.
  LabBed(const LabConditions& conditions, const LabBox& box, const std::vector<Float4>& soil, int classes,
         const std::vector<std::vector<Vec3>>& bodies_m);

  /// As above, with a bed that starts as an interactive one, and a tool.
  LabBed(const LabConditions& conditions, const BedParameters& bed, const ToolParameters& tool);

  [[nodiscard]] Bed& bed() noexcept { return bed_; }
  [[nodiscard]] const Bed& bed() const noexcept { return bed_; }
  [[nodiscard]] double dt() const noexcept { return dt_s_; }
  [[nodiscard]] double time() const noexcept { return time_s_; }

  /// Returns the number of soil particles. Particles 0 to soil() - 1 are soil; the rest belongs to bodies.
  [[nodiscard]] std::size_t soil() const noexcept { return soil_; }
  [[nodiscard]] Vec3 centre(std::size_t particle) const noexcept;
  [[nodiscard]] std::vector<Vec3> soilCentres() const;

  /// Returns the height below which a fraction `share` of the soil's particles have their tops, in m.
  [[nodiscard]] double surfaceHeight(double share = 0.98) const;
  [[nodiscard]] double surfaceHeight(DepthFrom from) const;

  /// Returns the height of the surface of an equivalent soil of uniform density, that of 3 to 7 R below the tips, in m.
  /// This is the surface in continuum equations (Gibbs' dividing surface of mass).
  [[nodiscard]] double levelSurface() const;

  /// Returns the mass of the soil with centres between two heights over the volume there, in kg/m^3. The depleted
  /// layers at the walls are included.
  [[nodiscard]] double bulkDensity(double bottom_m, double top_m) const;

  void moveBody(std::size_t body, const Vec3& velocity_m_s) noexcept;
  /// Returns the force of the soil on a body in the last step, in N, scene frame. Forces between its particles cancel.
  [[nodiscard]] Vec3 forceOnBody(std::size_t body) const noexcept;
  [[nodiscard]] Vec3 centreOfBody(std::size_t body) const noexcept;

  // A tool with a joint turns about its hub: pose, twist and wrench below are those of the hub.
  void placeTool(const Pose& scene_T_tool) noexcept { tool_pose_ = scene_T_tool; }
  /// @param twist  twist of the tool's origin, scene frame.
  void moveTool(const Twist& twist) noexcept { tool_twist_ = twist; }
  [[nodiscard]] const Pose& toolPose() const noexcept { return tool_pose_; }  ///< scene_T_tool
  /// Returns the soil wrench of the last step, about the tool's origin, scene frame.
  [[nodiscard]] const Wrench& toolWrench() const noexcept { return wrench_; }
  /// Sets the speed or torque of the joint's motor, in rad/s or N m.
  void driveJoint(double value) noexcept;
  /// Returns the angle and speed of the joint, and its torques in the last step.
  [[nodiscard]] const JointState& joint() const noexcept { return joint_; }

  /// Advances the tool and the bed by one time step. @throws Failure when the bed has failed.
  void step();

  /// Runs for `duration_s`; calls `each` after every step and the conditions' progress now and then.
  /// @throws Failure as step(), and when progress cancels the test.
  void run(double duration_s, std::string_view what, const std::function<void()>& each = {}) {
    run(duration_s, what, each, {0, 1});
  }

  /// Lets the soil fall until it is at rest. Dense: without friction and cohesion until all but `still_moving` of it is
  /// nearly at rest, then with them until all is. Loose: with them, which leaves gaps. Medium: as loose, then without
  /// them for the time that a particle takes to fall by its radius, then with them again.
  /// @param still_moving  a few particles slide over a surface without friction for many times as long as the bed takes
  ///                      to become dense: waiting for them adds 0.1 to 0.7 % of density. 0: until all are at rest.
  /// @throws Failure as run(), and when it does not settle.
  void settle(Preparation preparation = Preparation::kDense, double still_moving = 0.01);

 private:
  /// Range of the reported progress, in fractions.
  struct Part {
    double begin, end;
  };
  void run(double duration_s, std::string_view what, const std::function<void()>& each, const Part& part);
  [[nodiscard]] double fractionFasterThan(double speed_m_s) const noexcept;
  /// @param still_moving  fraction of the particles that need not be at rest.
  void settleUntilRest(double longest_s, std::string_view what, const Part& part, double still_moving = 0);
  void meetSoil() noexcept;

  LabConditions conditions_;
  double dt_s_;
  std::size_t soil_;
  std::vector<std::size_t> body_begin_;  ///< first particle of each body, and the end
  Bed bed_;
  std::optional<ToolParameters> tool_;
  ToolMemory tool_memory_{bed_};
  Pose tool_pose_;
  Twist tool_twist_;
  JointState joint_;
  Wrench wrench_;
  double time_s_ = 0;
};

}  // namespace haptolith

#pragma once

#include <optional>
#include <span>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/tool/tool_contact.h"

namespace haptolith {

/// How the soil comes into the box.
enum class Preparation {
  kDense,  ///< as if shaken: stronger before it fails than afterwards
  kLoose,  ///< as if poured: yields until it is as strong as it gets
};

/// What depth counts from. Grains are large, and their tips stand higher than the soil that they stand for.
enum class DepthFrom {
  kTips,     ///< where a plate first meets any; for other tools the height under which 98 % of the grains have theirs
  kSurface,  ///< where the soil would end if it were as dense up to there as it is below: LabBed::levelSurface()
};

/// The box a test is done in. Axes as in BedParameters.
struct LabBox {
  double width_m = 0.2, length_m = 0.2;
  bool periodic_x = false, periodic_y = false;
  double wall_friction_ratio = 0;  ///< of the side walls: smooth, so that they stand for more soil
};

/// Centres for loose soil above `bottom_m`, about `particles` of them, at random on a grid wide enough that none touch;
/// `inside` says where there may be soil. Lowest first. To be settled loosely every other storey stands over the gaps
/// of the one below: particles do not turn, so with friction on a straight column of them would not fall.
[[nodiscard]] std::vector<Vec3> looseSoil(const SoilParameters& soil, const LabBox& box, std::size_t particles,
                                          double bottom_m, std::uint64_t seed,
                                          const std::function<bool(const Vec3&)>& inside = {},
                                          Preparation preparation = Preparation::kDense);

/// The same soil with grains of `classes` sizes (GrainClasses), a like volume of each, mixed at random: in a place of
/// `loose` stands one grain of the coarsest class, or eight of half its radius, or so on. In whole groups of each
/// class.
[[nodiscard]] std::vector<Float4> mixedGrains(const SoilParameters& soil, const std::vector<Vec3>& loose, int classes,
                                              std::uint64_t seed);

/// How many particles fill `volume_m3` when densely packed without load. @throws InvalidParameter for more than three
/// million.
[[nodiscard]] std::size_t particlesFor(const SoilParameters& soil, double volume_m3);

/// Centres of a rough, tight plate over the whole box: closer together than particles are wide, at random heights of
/// +-0.6 R around `height_m`.
[[nodiscard]] std::vector<Vec3> roughPlate(const SoilParameters& soil, const LabBox& box, double height_m,
                                           std::uint64_t seed);

/// A box with soil, bodies made of driven particles (rough plates, floors) and a tool that goes where it is told: what
/// every test is built of. Steps somewhat shorter than a bed in the hand, not in ticks of 1 ms.
class LabBed {
 public:
  /// @param bodies  centres of the particles of each body; they stand still until moveBody().
  /// @throws InvalidParameter as Bed, and when a step would have to be shorter than 1 us.
  LabBed(const LabConditions& conditions, const LabBox& box, const std::vector<Vec3>& soil_m,
         const std::vector<std::vector<Vec3>>& bodies_m = {}, const std::optional<ToolParameters>& tool = {});

  /// The same with grains of each one's size, of several classes or one; bodies are of class 0.
  LabBed(const LabConditions& conditions, const LabBox& box, const std::vector<Float4>& soil, int classes,
         const std::vector<std::vector<Vec3>>& bodies_m);

  /// A bed that starts as beds in the hand do, and a tool.
  LabBed(const LabConditions& conditions, const BedParameters& bed, const ToolParameters& tool);

  [[nodiscard]] Bed& bed() noexcept { return bed_; }
  [[nodiscard]] const Bed& bed() const noexcept { return bed_; }
  [[nodiscard]] double dt() const noexcept { return dt_s_; }
  [[nodiscard]] double time() const noexcept { return time_s_; }

  /// Particles 0 to soil() - 1 are soil, those behind belong to bodies.
  [[nodiscard]] std::size_t soil() const noexcept { return soil_; }
  [[nodiscard]] Vec3 centre(std::size_t particle) const noexcept;
  [[nodiscard]] std::vector<Vec3> soilCentres() const;

  /// Height under which `share` of the soil's particles have their top.
  [[nodiscard]] double surfaceHeight(double share = 0.98) const;
  [[nodiscard]] double surfaceHeight(DepthFrom from) const;

  /// Height at which the same soil would end had it one density, that of 3 to 7 R below the tips, up to a sharp
  /// surface: what equations of continua mean by theirs (Gibbs' dividing surface of mass).
  [[nodiscard]] double levelSurface() const;

  /// Mass of the soil with its centres between two heights over the volume there, in kg/m^3, walls' shadows included.
  [[nodiscard]] double bulkDensity(double bottom_m, double top_m) const;

  void moveBody(std::size_t body, const Vec3& velocity_m_s) noexcept;
  /// Force of the soil on a body in the last step, in N. Forces between its own particles cancel.
  [[nodiscard]] Vec3 forceOnBody(std::size_t body) const noexcept;
  [[nodiscard]] Vec3 centreOfBody(std::size_t body) const noexcept;

  void placeTool(const Pose& scene_T_tool) noexcept { tool_pose_ = scene_T_tool; }
  /// @param twist  of the tool's origin, scene frame.
  void moveTool(const Twist& twist) noexcept { tool_twist_ = twist; }
  [[nodiscard]] const Pose& toolPose() const noexcept { return tool_pose_; }  ///< scene_T_tool
  /// Soil wrench of the last step, about the tool's origin, scene frame.
  [[nodiscard]] const Wrench& toolWrench() const noexcept { return wrench_; }

  /// One step of the tool and the bed. @throws Failure when the bed is no longer sound.
  void step();

  /// Steps for `duration_s`, calling `each` after every step and the conditions' progress now and then.
  /// @throws Failure as step(), and when progress gives up.
  void run(double duration_s, std::string_view what, const std::function<void()>& each = {}) {
    run(duration_s, what, each, {0, 1});
  }

  /// Lets the soil fall until it rests. Densely: without friction and cohesion, which are then switched on, and it
  /// rests again. Loosely: with them on, which leaves gaps. @throws Failure as run(), and when it never rests.
  void settle(Preparation preparation = Preparation::kDense);

 private:
  /// Fractions of what is reported as progress.
  struct Part {
    double begin, end;
  };
  void run(double duration_s, std::string_view what, const std::function<void()>& each, const Part& part);
  void settleUntilRest(double longest_s, std::string_view what, const Part& part);

  LabConditions conditions_;
  double dt_s_;
  std::size_t soil_;
  std::vector<std::size_t> body_begin_;  ///< one more than there are bodies
  Bed bed_;
  std::optional<ToolParameters> tool_;
  Pose tool_pose_;
  Twist tool_twist_;
  Wrench wrench_;
  double time_s_ = 0;
};

}  // namespace haptolith

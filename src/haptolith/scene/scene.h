#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/core/assert.h"
#include "haptolith/core/movement.h"
#include "haptolith/scene/force_band.h"
#include "haptolith/tool/tool_memory.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Whether a place is in the space that a hand at a table reaches: 1 m around the box, under it too, and 3 m above its
/// floor. May be called in the tick.
[[nodiscard]] bool isNearBed(const BedParameters& bed, const Vec3& place_m) noexcept;

/// A tool between two ticks, with everything that determines its next ticks.
struct SavedTool {
  HandState hand;        ///< scene frame; how far jaws are to open; its twist does not count
  double opening_m = 0;  ///< between the jaws
  double fade = 1;
  ToolForce soil_force;  ///< soil wrench of the last tick, scene frame
  Eigen::Matrix3d contact_stiffness_n_m = Eigen::Matrix3d::Zero();
  JointState joint;
  SavedToolMemory memory;
};

/// A scene between two ticks, with everything that determines its next ticks.
struct SavedScene {
  SavedBed bed;
  std::vector<SavedTool> tools;
};

/// As bytes, and back. @throws Failure when the bytes are no saved scene, are cut short or of another version.
[[nodiscard]] std::string serialise(const SavedScene& saved);
[[nodiscard]] SavedScene deserialiseSavedScene(std::string_view bytes);

/// The tools of a scene: none to kMost of them.
class ToolSet {
 public:
  static constexpr std::size_t kMost = 16;

  /// One tool.
  ToolSet(const ToolParameters& tool = {})
      : tools_{tool} {}  // NOLINT(google-explicit-constructor): a tool is a set of one
  /// @throws InvalidParameter for more than kMost.
  explicit ToolSet(std::vector<ToolParameters> tools);

  [[nodiscard]] std::span<const ToolParameters> all() const noexcept { return tools_; }

 private:
  std::vector<ToolParameters> tools_;
};

/// Refuses tools on joints with less inertia than a step bears. @throws InvalidParameter.
void requireEnoughInertia(const BedParameters& bed, const ToolSet& tools, int substeps);

/// A bed and tools in it: what stands between poses and wrenches. No device and no clock.
///
/// Tools have numbers from 0 on. They meet the soil one after the other, at the same places of its particles; a
/// particle that several of them touch feels the sum, in order of their numbers.
class Scene {
 public:
  /// @throws InvalidParameter when the parameters are not valid, or when one tick would need too many substeps; Failure
  /// as Bed::settle().
  Scene(const BedParameters& bed, const ToolSet& tools, const SettleProgress& progress = {});

  /// As above with soil and stones at given positions, at rest; the seed determines each particle's size.
  Scene(const BedParameters& bed, const ToolSet& tools, const std::vector<Vec3>& centres_m,
        const std::vector<Pose>& stones = {});

  /// As above from soil of a bed with such parameters, with each particle's size: the seed does not determine it where
  /// soil was repeated from a tile or surrounds stones.
  Scene(const BedParameters& bed, const ToolSet& tools, const LyingSoil& lying);

  /// Continues a saved scene bit for bit, without settling its soil again.
  /// @throws InvalidParameter as restore().
  Scene(const BedParameters& bed, const ToolSet& tools, const SavedScene& saved);

  /// One tick: moves each tool from where it was to where its hand has it, and opens jaws, in equal substeps, steps the
  /// bed each time, and leaves the mean of the soil's force in soilForce(). The hands are those of the first tools;
  /// the others stay where they are. An opening that is not finite changes nothing; no tool but jaws takes notice of
  /// one. When a hand is nowhere (a pose or twist that is not finite, an orientation whose norm is not 1) the tick is
  /// kNotFinite: nothing moves then, soil wrenches are zero, and the scene can continue. May be called in the tick.
  [[nodiscard]] StepStatus tickAll(std::span<const HandState> hands) noexcept;
  /// As above with the first tool's hand alone.
  [[nodiscard]] StepStatus tick(const HandState& hand) noexcept { return tickAll(std::span(&hand, 1)); }

  [[nodiscard]] std::size_t tools() const noexcept { return tools_.size(); }

  /// Soil wrench: of the soil on a tool, mean over the last tick, about the tool's origin (its hub's if it has a
  /// joint), scene frame, unfiltered.
  [[nodiscard]] const Wrench& soilWrench(std::size_t tool = 0) const noexcept { return at(tool).soil_force.wrench; }
  /// The soil wrench and the force that pushed jaws apart (see ToolReaction), 0 with another tool.
  [[nodiscard]] const ToolForce& soilForce(std::size_t tool = 0) const noexcept { return at(tool).soil_force; }

  /// Range of the mean magnitude of the soil force over the last 0.25 s: forceRange(). Empty as that, in the first
  /// 0.25 s, and in beds with particles of several sizes. May be called in the tick.
  [[nodiscard]] std::optional<ForceRange> forceBand(std::size_t tool = 0) const noexcept;

  /// Force of a tool on its hand: the soil force; with a joint, the opposite of the motor's torque about the axis
  /// instead of the soil's. May be called in the tick.
  [[nodiscard]] ToolForce handForce(std::size_t tool = 0) const noexcept;

  /// Angle, speed and torques of a tool's joint; zero without one.
  [[nodiscard]] const JointState& joint(std::size_t tool = 0) const noexcept { return at(tool).joint; }
  /// Sets what a joint's drive holds: its speed in rad/s, or its torque in N m. A value out of JointRanges counts as
  /// the nearer end. Nothing changes for NaN, nor for a tool without a joint or with a free one. May be called in the
  /// tick.
  void setDrive(double value, std::size_t tool = 0) noexcept;

  /// Derivative of the force by the tool's position at the end of the last tick: see ToolReaction.
  [[nodiscard]] const Eigen::Matrix3d& contactStiffness(std::size_t tool = 0) const noexcept {
    return at(tool).stiffness_n_m;
  }

  /// Between the jaws now, in m; 0 with another tool.
  [[nodiscard]] double opening(std::size_t tool = 0) const noexcept {
    return at(tool).parameters.shape == ToolShape::kJaws ? at(tool).opening_m : 0;
  }

  /// Places a tool at `hand` without moving it there, and sets the opening of jaws. A tool without a pose, see
  /// tickAll(), keeps its place.
  void placeTool(const HandState& hand, std::size_t tool = 0) noexcept;

  /// Sets the present fraction of a tool, 0 to 1: its stiffness, damping and cohesion are scaled, in both
  /// directions. Soil inside a tool is moved out gently when this grows slowly. May be
  /// called in the tick.
  void setToolFade(double share, std::size_t tool = 0) noexcept { at(tool).fade = share; }
  [[nodiscard]] double toolFade(std::size_t tool = 0) const noexcept { return at(tool).fade; }

  /// Another tool, as stiff as the one before it (else a tick might need more substeps), which forgets what the other
  /// touched. May be called in the tick.
  void setTool(const ToolParameters& parameters, std::size_t tool = 0) noexcept;

  /// Sets the friction between soil and a tool; contacts persist. May be called in the tick.
  void setToolFriction(double friction, std::size_t tool = 0) noexcept { at(tool).parameters.friction = friction; }

  /// As Bed::moveGrain(), away from the tools: what they touch, and what lies within two grains' width of the spheres
  /// around them, stays. May be called in the tick.
  [[nodiscard]] bool moveGrain(const GrainMove& move) noexcept;

  /// Returns everything that this scene, or another of equal parameters, needs to continue from here. Not for the tick.
  [[nodiscard]] SavedScene save() const;
  /// Not for the tick. @throws InvalidParameter as Bed::restore(), for another number of tools, and for a tool that is
  /// nowhere; the scene is then as it was.
  void restore(const SavedScene& saved);

  [[nodiscard]] Bed& bed() noexcept { return bed_; }
  [[nodiscard]] const Bed& bed() const noexcept { return bed_; }
  [[nodiscard]] const ToolParameters& tool(std::size_t tool = 0) const noexcept { return at(tool).parameters; }
  [[nodiscard]] const Pose& toolPose(std::size_t tool = 0) const noexcept { return at(tool).pose; }  ///< scene_T_tool
  /// Pose of the tool as its joint has turned it, where its shape is: toolPose() without a joint. May be called in the
  /// tick.
  [[nodiscard]] Pose turnedToolPose(std::size_t tool = 0) const noexcept { return at(tool).turnedPose(); }
  [[nodiscard]] const ToolMemory& toolMemory(std::size_t tool = 0) const noexcept { return at(tool).memory; }
  [[nodiscard]] int substeps() const noexcept { return substeps_; }
  /// `times` as many substeps as are needed, to compare steps.
  void refineSteps(int times) noexcept { substeps_ *= times; }
  /// As Bed::hash(), with what the tools remember of their contacts. May be called in the tick.
  [[nodiscard]] std::uint64_t hash(std::size_t part = 0, std::size_t parts = 1) const noexcept;
  /// Bytes of memory in use, bed and tools together.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Tool {
    Tool(const ToolParameters& tool, const Bed& bed)
        : parameters(tool),
          opening_m(tool.opening_m),
          joint(atStart(tool)),
          memory(bed),
          recent_force(bed.parameters().tick_s) {}

    void open(double share) noexcept;
    void startTick(double tick_s) noexcept;
    [[nodiscard]] Pose turnedPose() const noexcept;
    [[nodiscard]] MeanForce nowInSoil() const noexcept;
    [[nodiscard]] static JointState atStart(const ToolParameters& tool) noexcept {
      return {.speed_rad_s = tool.joint.any() ? tool.joint.speed_rad_s : 0};
    }
    void recall(const SavedTool& saved) noexcept;

    ToolParameters parameters;
    Pose pose;
    double opening = 1;  ///< opening of the jaws at the end of the tick
    double opening_m;    ///< now
    double fade = 1;
    ToolForce soil_force;
    Eigen::Matrix3d stiffness_n_m = Eigen::Matrix3d::Zero();
    JointState joint;
    ToolMemory memory;
    RecentForce recent_force;  ///< soil force; not saved

    // State within a tick.
    ToolParameters present;  ///< faded and opened as now
    double opening_m_s = 0;
    ToolForce sum;                                           ///< sum over the substeps so far
    double soil_torque_sum_nm = 0, motor_torque_sum_nm = 0;  ///< about the axis
  };
  [[nodiscard]] static int substepsOf(const BedParameters& bed, const ToolSet& tools);
  void makeTools(const ToolSet& tools);
  void meetSoil(Tool& tool, const HandState& hand, double share, double dt_s) noexcept;
  void requireSound(const SavedScene& saved) const;
  void recallTools(const SavedScene& saved) noexcept;
  [[nodiscard]] Tool& at(std::size_t tool) noexcept {
    HAPTO_ASSERT(tool < tools_.size());
    return tools_[tool];
  }
  [[nodiscard]] const Tool& at(std::size_t tool) const noexcept {
    HAPTO_ASSERT(tool < tools_.size());
    return tools_[tool];
  }

  int substeps_;
  Bed bed_;
  std::vector<Tool> tools_;
};

}  // namespace haptolith

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/core/movement.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Whether a place is in the space that a hand at a table reaches: 1 m around the box, under it too, and 3 m above its
/// floor. May be called in the tick.
[[nodiscard]] bool isNearBed(const BedParameters& bed, const Vec3& place_m) noexcept;

/// A scene between two ticks, with everything that determines its next ticks.
struct SavedScene {
  SavedBed bed;
  HandState tool;        ///< scene frame; how far jaws are to open; its twist does not count
  double opening_m = 0;  ///< between the jaws
  double tool_fade = 1;
  ToolForce soil_force;  ///< soil wrench of the last tick, scene frame
  Eigen::Matrix3d contact_stiffness_n_m = Eigen::Matrix3d::Zero();
};

/// As bytes, and back. @throws Failure when the bytes are no saved scene, are cut short or of another version.
[[nodiscard]] std::string serialise(const SavedScene& saved);
[[nodiscard]] SavedScene deserialiseSavedScene(std::string_view bytes);

/// A bed and a tool in it: what stands between a pose and a wrench. No device and no clock.
class Scene {
 public:
  /// @throws InvalidParameter when the parameters are not valid, or when one tick would need too many substeps; Failure
  /// as Bed::settle().
  Scene(const BedParameters& bed, const ToolParameters& tool, const SettleProgress& progress = {});

  /// As above with soil and stones at given positions, at rest; the seed determines each particle's size.
  Scene(const BedParameters& bed, const ToolParameters& tool, const std::vector<Vec3>& centres_m,
        const std::vector<Pose>& stones = {});

  /// As above from soil of a bed with such parameters, with each particle's size: the seed does not determine it where
  /// soil was repeated from a tile or surrounds stones.
  Scene(const BedParameters& bed, const ToolParameters& tool, const LyingSoil& lying);

  /// Continues a saved scene bit for bit, without settling its soil again.
  /// @throws InvalidParameter as restore().
  Scene(const BedParameters& bed, const ToolParameters& tool, const SavedScene& saved);

  /// One tick: moves the tool from where it was to where `hand` has it, and opens jaws, in equal substeps, steps the
  /// bed each time, and leaves the mean of the soil's force in soilForce(). An opening that is not finite changes
  /// nothing; no tool but jaws takes notice of one. A tool that is nowhere (a pose or twist that is not finite, an
  /// orientation whose norm is not 1) is kNotFinite: nothing moves then, the soil wrench is zero, and the scene can go
  /// on. May be called in the tick.
  [[nodiscard]] StepStatus tick(const HandState& hand) noexcept;

  /// Soil wrench: of the soil on the tool, mean over the last tick, about the tool's origin, scene frame, unfiltered.
  [[nodiscard]] const Wrench& soilWrench() const noexcept { return soil_force_.wrench; }
  /// The soil wrench and the force that pushed jaws apart (see ToolReaction), 0 with another tool.
  [[nodiscard]] const ToolForce& soilForce() const noexcept { return soil_force_; }

  /// Derivative of the force by the tool's position at the end of the last tick: see ToolReaction.
  [[nodiscard]] const Eigen::Matrix3d& contactStiffness() const noexcept { return stiffness_n_m_; }

  /// Between the jaws now, in m; 0 with another tool.
  [[nodiscard]] double opening() const noexcept { return tool_.shape == ToolShape::kJaws ? opening_m_ : 0; }

  /// Places the tool at `hand` without moving it there, and sets the opening of jaws. A tool without a pose, see
  /// tick(), keeps its place.
  void placeTool(const HandState& hand) noexcept;

  /// Sets the present fraction of the tool, 0 to 1: its stiffness, damping and cohesion are scaled, in both
  /// directions. Soil inside a tool is moved out gently when this grows slowly. May be
  /// called in the tick.
  void setToolFade(double share) noexcept { tool_fade_ = share; }
  [[nodiscard]] double toolFade() const noexcept { return tool_fade_; }

  /// Another tool, as stiff as the one before it (else a tick might need more substeps), which forgets what the other
  /// touched. May be called in the tick.
  void setTool(const ToolParameters& tool) noexcept;

  /// Sets the friction between soil and tool; contacts persist. May be called in the tick.
  void setToolFriction(double friction) noexcept { tool_.friction = friction; }

  /// As Bed::moveGrain(), away from the tool: what it touches, and what lies within two grains' width of the sphere
  /// around it, stays. May be called in the tick.
  [[nodiscard]] bool moveGrain(const GrainMove& move) noexcept;

  /// Returns everything that this scene, or another of equal parameters, needs to continue from here. Not for the tick.
  [[nodiscard]] SavedScene save() const;
  /// Not for the tick. @throws InvalidParameter as Bed::restore(), and for a tool that is nowhere; the scene is then as
  /// it was.
  void restore(const SavedScene& saved);

  [[nodiscard]] Bed& bed() noexcept { return bed_; }
  [[nodiscard]] const Bed& bed() const noexcept { return bed_; }
  [[nodiscard]] const ToolParameters& tool() const noexcept { return tool_; }
  [[nodiscard]] const Pose& toolPose() const noexcept { return tool_pose_; }  ///< scene_T_tool
  [[nodiscard]] int substeps() const noexcept { return substeps_; }

 private:
  [[nodiscard]] static int substepsOf(const BedParameters& bed, const ToolParameters& tool);
  void open(double share) noexcept;
  void recallTool(const SavedScene& saved) noexcept;

  ToolParameters tool_;
  int substeps_;
  Bed bed_;
  Pose tool_pose_;
  double opening_ = 1;  ///< opening of the jaws at the end of the tick
  double opening_m_;    ///< now
  double tool_fade_ = 1;
  ToolForce soil_force_;
  Eigen::Matrix3d stiffness_n_m_ = Eigen::Matrix3d::Zero();
};

}  // namespace haptolith

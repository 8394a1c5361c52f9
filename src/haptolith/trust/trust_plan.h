#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/scene_file/scene_file.h"

namespace haptolith {

/// Difference between a scene and one that should render the same force.
enum class TrustChange {
  kNone,    ///< another specimen of the same soil
  kWideX,   ///< a box twice as wide along x
  kWideY,   ///< along y
  kDeep,    ///< a floor twice as far below the surface
  kRadius,  ///< particles of another radius, of the same soil
  kStep,    ///< twice as many steps per tick
  kAwake,   ///< particles at rest do not sleep
  kStiff,   ///< contacts of soil and tool twice as stiff
  kMesh,    ///< the tool's shape as a mesh
};

/// One simulation for `haptolith trust`.
struct TrustRun {
  TrustChange change = TrustChange::kNone;
  double radius_ratio = 1;      ///< kRadius: its radius over the scene's
  std::size_t specimen = 0;     ///< equal numbers have the same seed, and the same place of the tool
  SceneFile scene;              ///< as changed
  Vec3 shift_m = Vec3::Zero();  ///< shift of the tool: specimens of soil without a seed differ by it
  int step_factor = 1;          ///< steps per tick over those needed
  /// kDeep: height of the scene's own soil, by which a movement with given heights is raised.
  std::optional<double> usual_surface_m{};
};

/// The name of a change in files and options: "wide-x".
[[nodiscard]] std::string_view nameOf(TrustChange change) noexcept;
/// A row's title: "box twice as wide, x"; of kRadius for this ratio.
[[nodiscard]] std::string titleOf(TrustChange change, double radius_ratio = 1);

/// A run, or the reason why a scene cannot be changed so.
struct PlannedRun {
  std::optional<TrustRun> run;
  std::string why_not;  ///< "its particles have given places"; empty with a run
};

/// Returns one specimen of a scene under a change.
[[nodiscard]] PlannedRun planned(const SceneFile& scene, TrustChange change, std::size_t specimen,
                                 double radius_ratio = 1);

/// Whether the seed of a scene's soil makes another specimen of it; else the tool is shifted by up to R.
[[nodiscard]] bool hasSeed(const SceneFile& scene) noexcept;

/// Cost of a run over that of the scene itself: particles times steps, of settling and of the movement.
[[nodiscard]] double relativeCost(TrustChange change, double radius_ratio) noexcept;

}  // namespace haptolith

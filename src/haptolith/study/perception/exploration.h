#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// Undisturbed soil, settled once and used for any number of explorations.
struct LevelBed {
  LyingSoil lying;
  double surface_m = 0;
};

/// Settles the soil of a scene.
/// @throws InvalidParameter, Failure: as Scene.
[[nodiscard]] LevelBed levelBed(const SceneFile& scene_file, const SettleProgress& progress = {});

/// Options of the exploration of soil by a virtual hand.
struct ExplorationOptions {
  HandMotion motion = HandMotion::kStir;  ///< not kPoses
  int rounds = 2;                         ///< repetitions of the motion, 1 to 1000
  std::uint64_t seed = 1;
  /// Factor on the random differences between explorations, 0 to 2: see exploringHand(). 0: no differences.
  double variation = 1;
};

/// Hand of one exploration, and the side of the bed from which it comes.
struct ExploringHand {
  HandParameters hand = {};
  int quarter_turns = 0;  ///< quarter turns of the soil under the hand, which comes from another side
  bool mirrored = false;  ///< mirrors the soil at the scene's x-z plane; never with stones (handedness)
};

/// Draws the hand for `options.seed`. With a variation of 1, the draws are uniform: home position +- 5 mm in x and y;
/// period and depth +- 10 %; the arm's mass, damping and stiffness together +- 20 %. The side of the bed is also drawn,
/// and whether the bed is mirrored.
/// @throws InvalidParameter for options out of range.
[[nodiscard]] ExploringHand exploringHand(const SceneFile& scene_file, const ExplorationOptions& options);

/// Checks that the scene's hand reaches the soil in this motion: at least a particle radius below the surface.
/// @throws InvalidParameter with the depth that the tool reaches.
void requireReach(const SceneFile& scene_file, HandMotion motion);

/// Visual information for an observer of an exploration: measures of the soil's visible surface, in m.
struct Picture {
  double height_m = 0;   ///< mean height of the surface above the floor before the exploration
  double heave_m = 0;    ///< maximum rise of the surface after the exploration
  double hollow_m = 0;   ///< maximum fall of the surface after the exploration
  double moved_m = 0;    ///< mean displacement of the surface particles
  double reached_m = 0;  ///< maximum depth of the tool's origin below the undisturbed surface
  /// Edge of a cube with the mean volume of the soil that the tool carries; NaN if it never carries soil.
  double load_m = std::numeric_limits<double>::quiet_NaN();
};

/// Computes the picture from the centres of all particles before and after; equal indices are the same particle. A cell
/// of the surface is as wide as a particle, and its highest particle is visible.
[[nodiscard]] Picture pictureOf(const std::vector<Vec3>& before_m, const std::vector<Vec3>& after_m,
                                const BedParameters& bed);

/// Movements of a hand and forces on it in one exploration.
struct Exploration {
  TrialSummary summary;
  Picture seen = {};
  /// Work divided by path: the mean force against the movement, N.
  double drag_n = std::numeric_limits<double>::quiet_NaN();
  /// Mean downward force on the hand while the tool carries soil (nose up, near its highest position), N; NaN if it
  /// never carries soil.
  double carried_n = std::numeric_limits<double>::quiet_NaN();
  /// Mean mass of the soil above the tool at these times, kg, whether or not it presses on the tool.
  double carried_kg = std::numeric_limits<double>::quiet_NaN();
  /// Largest height of the tool's origin above the floor with a soil force of at least 0.1 N: mean over the entries
  /// into the soil, m; NaN if there was none.
  double touched_up_to_m = std::numeric_limits<double>::quiet_NaN();
};

/// Explores soil by a script, without clock and device, as fast as the machine allows. Equal arguments give equal
/// numbers. Takes a fraction of a second of computing for the scene of icra2021.
/// @param bed  levelBed() of the same scene.
/// @throws InvalidParameter for options out of range and as HapticLoop; Failure if the exploration cannot continue, or
/// if stopAsked().
[[nodiscard]] Exploration explore(const SceneFile& scene_file, const LevelBed& bed, const ExplorationOptions& options);

/// As above, for a given hand.
[[nodiscard]] Exploration explore(const SceneFile& scene_file, const LevelBed& bed, const ExploringHand& exploring,
                                  int rounds);

/// As above, on a bed that is settled for this exploration.
[[nodiscard]] Exploration explore(const SceneFile& scene_file, const ExplorationOptions& options);

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// Undisturbed soil, settled once, for as many explorations as wanted.
struct LevelBed {
  LyingSoil lying;
  double surface_m = 0;
};

/// The soil of a scene before anybody touches it.
/// @throws InvalidParameter, Failure: as Scene.
[[nodiscard]] LevelBed levelBed(const SceneFile& scene_file, const SettleProgress& progress = {});

/// How a virtual hand explores soil.
struct ExplorationOptions {
  Manoeuvre manoeuvre = Manoeuvre::kStir;  ///< not kPoses
  int rounds = 2;                          ///< of the manoeuvre, 1 to 1000
  std::uint64_t seed = 1;
  /// How much one exploration differs from the next, 0 to 2: see exploringHand(). 0: not at all.
  double variation = 1;
};

/// One exploration: which hand comes to which side of the bed.
struct ExploringHand {
  HandParameters hand = {};
  int quarter_turns = 0;  ///< of the soil under the hand: it comes from another side
  bool mirrored = false;  ///< the soil, across the scene's x-z plane; never where stones lie, which have a handedness
};

/// Draws how the hand of `options.seed` explores. With a variation of 1, evenly: the place up to 5 mm from the scene's
/// in x and y, tempo and depth up to 10 %, the arm's mass, damping and stiffness together up to 20 % more or less; the
/// bed from any side, and mirrored or not.
/// @throws InvalidParameter for options out of range.
[[nodiscard]] ExploringHand exploringHand(const SceneFile& scene_file, const ExplorationOptions& options);

/// That a hand of the scene's comes into soil by this manoeuvre: a particle's radius below the surface, or more.
/// @throws InvalidParameter with how deep the tool comes.
void requireReach(const SceneFile& scene_file, Manoeuvre manoeuvre);

/// What somebody sees who only looks on while a hand explores: numbers of the soil's visible surface, in m.
struct Picture {
  double height_m = 0;   ///< mean height of the surface over the floor before the hand comes
  double heave_m = 0;    ///< largest rise of the surface in the end, anywhere
  double hollow_m = 0;   ///< largest fall of the surface in the end, anywhere
  double moved_m = 0;    ///< mean way of the grains that lay on the surface
  double reached_m = 0;  ///< how far below the undisturbed surface the tool's origin came
  /// Edge of a cube as large as the soil that the tool carries, on average; NaN when it never carries.
  double load_m = std::numeric_limits<double>::quiet_NaN();
};

/// All of the soil that lies, of grains before and after; one number, one grain. A cell of the surface is as wide as a
/// grain, and what its highest grain does is seen.
[[nodiscard]] Picture pictureOf(const std::vector<Vec3>& before_m, const std::vector<Vec3>& after_m,
                                const BedParameters& bed);

/// What a hand did and felt.
struct Exploration {
  TrialSummary summary;
  Picture seen = {};
  /// Work over path: the mean force against the movement, N.
  double drag_n = std::numeric_limits<double>::quiet_NaN();
  /// Mean downward force on the hand while it carries: its nose is up, and it is as high as it comes. N; NaN when
  /// it never carries.
  double carried_n = std::numeric_limits<double>::quiet_NaN();
  /// Mean mass of the soil above the tool meanwhile, in kg, whether it presses on the tool or not.
  double carried_kg = std::numeric_limits<double>::quiet_NaN();
  /// How high over the floor the tool's origin came where it still felt soil, 0.1 N or more: mean over the times that
  /// it went into soil, m; NaN when it never did.
  double touched_up_to_m = std::numeric_limits<double>::quiet_NaN();
};

/// Explores soil by a script, as fast as the machine can: no clock, no device. The same arguments give the same
/// numbers. Takes a fraction of a second of computing for the paper's scene.
/// @param bed  levelBed() of the same scene.
/// @throws InvalidParameter for options out of range and as HapticLoop; Failure when the exploration cannot go on, or
/// when stopAsked().
[[nodiscard]] Exploration explore(const SceneFile& scene_file, const LevelBed& bed, const ExplorationOptions& options);

/// The same for a hand that has been chosen already.
[[nodiscard]] Exploration explore(const SceneFile& scene_file, const LevelBed& bed, const ExploringHand& exploring,
                                  int rounds);

/// The same on a bed that is settled for it.
[[nodiscard]] Exploration explore(const SceneFile& scene_file, const ExplorationOptions& options);

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "haptolith/study/perception/perception.h"
#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// d' of an ideal observer, see dPrime().
struct Detectability {
  double d_prime = 0;
  Interval interval = {};  ///< bootstrap percentiles over explorations
};

/// Detectability of one level of a block against the reference: by force alone, by vision alone, and by vision of the
/// soil without the tool.
struct TaskLevel {
  std::string name;
  double value = 0;
  Detectability force, picture, soil_picture;
};

/// Means of one cue for the reference and each level.
struct TaskCue {
  std::string name, unit;
  bool is_seen = false;
  double reference = 0;
  std::vector<double> levels;
};

/// Observers' performance in a block of a study, explored by the hand of its scene.
struct TaskPerception {
  std::string block, reference, axis_label;
  HandMotion hand = HandMotion::kPress;
  double duration_s = 0;  ///< duration of one exploration of one stimulus
  std::vector<TaskLevel> levels;
  std::vector<TaskCue> cues;
};

struct TaskOptions {
  int repeats = 16;  ///< explorations of each stimulus, 4 or more
  int rounds = 2;    ///< repetitions of the hand's motion in each
  int beds = 4;      ///< realisations (seeds) of the bed of each stimulus
  std::uint64_t seed = 1;
  int threads = 1;
  PerceiveOptions perceive = {};
};

/// Explores the reference and every level with the hand of the block's scene, and evaluates three ideal observers. One
/// has only haptic cues (cues(), placeCues()), one only visual cues (seenCues()), and one only visual cues of the soil.
/// They have no other information about a stimulus. Cues that do not occur with the hand are left out.
/// @throws Failure if it was cancelled, and as explore(); InvalidParameter for options out of range, and for a hand
/// that follows poses.
[[nodiscard]] TaskPerception perceiveTask(const StudyProtocol& protocol, const StudyBlock& block,
                                          const TaskOptions& options, const PerceptionProgress& progress = {});

}  // namespace haptolith

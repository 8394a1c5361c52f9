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
  Interval interval = {};  ///< percentiles of what resampled explorations give
};

/// How well one level of a block is told from the reference: by force alone, by the picture alone, and by the picture
/// of the soil without the tool's.
struct TaskLevel {
  std::string name;
  double value = 0;
  Detectability force, picture, soil_picture;
};

/// Means of one cue, of the reference and of each level.
struct TaskCue {
  std::string name, unit;
  bool is_seen = false;
  double reference = 0;
  std::vector<double> levels;
};

/// A block of a study, explored by the hand of its scene.
struct TaskPerception {
  std::string block, reference, axis_label;
  Manoeuvre hand = Manoeuvre::kPress;
  double duration_s = 0;  ///< of one exploration of one stimulus
  std::vector<TaskLevel> levels;
  std::vector<TaskCue> cues;
};

struct TaskOptions {
  int repeats = 16;  ///< explorations of each stimulus, 4 or more
  int rounds = 2;    ///< of the hand's manoeuvre in each
  int beds = 4;      ///< of each stimulus, that differ in their grains
  std::uint64_t seed = 1;
  int threads = 1;
  PerceiveOptions perceive = {};
};

/// Lets the hand of the block's scene explore the reference and every level, and asks ideal observers: one who has only
/// the hand (cues(), placeCues()), one who has only the picture (seenCues()), and one who has only the soil's. None
/// knows anything else of a stimulus. Cues that the hand never has are left out.
/// @throws Failure when it was given up, and as explore(); InvalidParameter for options out of range, and for a hand
/// that follows poses.
[[nodiscard]] TaskPerception perceiveTask(const StudyProtocol& protocol, const StudyBlock& block,
                                          const TaskOptions& options, const PerceptionProgress& progress = {});

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/scene_file/scene_file.h"
#include "haptolith/study/perception/exploration.h"
#include "haptolith/study/perception/ideal_observer.h"

namespace haptolith {

/// Stimulus of the user study of icra2021, as a scene.
struct PerceptionStimulus {
  std::string name;  ///< "P3", "Moon"
  double x = 0;      ///< friction coefficient, or gravity in m/s^2
  SceneFile scene;
};

/// Explorations of one of the two experiments of icra2021, with one model of friction.
struct PerceptionBlock {
  std::string name;  ///< "friction" or "gravity"
  FrictionModel friction = FrictionModel::kIcra2021;
  std::vector<PerceptionStimulus> stimuli;  ///< in the order of their x
  std::size_t reference = 0;                ///< index in `stimuli`
  /// [stimulus][hand][repeat]
  std::vector<std::vector<std::vector<Exploration>>> explorations = {};
};

struct PerceptionOptions {
  std::vector<std::string> blocks{"friction", "gravity"};
  std::vector<FrictionModel> frictions{FrictionModel::kIcra2021, FrictionModel::kContact};
  std::vector<HandMotion> hands{HandMotion::kStir, HandMotion::kPress, HandMotion::kScoop};
  double contact_cohesion_n = 0;  ///< F_c of soil with contact friction
  int repeats = 15;               ///< explorations of each stimulus by each hand, 2 or more
  int rounds = 2;                 ///< repetitions of the motion in each
  std::uint64_t seed = 1;
  int threads = 1;
};

/// Receives the completed fraction, 0 to 1; returning false cancels.
using PerceptionProgress = std::function<bool(double share)>;

/// Explores every stimulus of the user study of icra2021 with virtual hands.
/// @throws Failure if it was cancelled, and as explore().
[[nodiscard]] std::vector<PerceptionBlock> explorePaperStimuli(const PerceptionOptions& options,
                                                               const PerceptionProgress& progress);

/// Performance of one observer in a block.
struct PerceivedCue {
  std::optional<HandMotion> hand = {};    ///< none: all hands, one after the other
  const Cue* cue = nullptr;               ///< null: all cues of the hand together
  std::vector<double> means, deviations;  ///< per stimulus, in the cue's unit; empty for combined cues
  Discrimination discrimination;
};

struct PerceiveOptions {
  ObserverOptions observer = {.resamplings = 200};
  double sense_scale = 1;  ///< factor on the Weber fractions and thresholds of all senses, 0.1 to 10; below 1: finer
};

/// Evaluates observers of each single cue of each hand, of all cues of each hand, and of all cues of all hands. Cues
/// that do not occur with a hand (the load of a hand that does not lift) are left out.
/// @throws InvalidParameter as discriminate().
[[nodiscard]] std::vector<PerceivedCue> perceive(const PerceptionBlock& block, const std::vector<HandMotion>& hands,
                                                 const PerceiveOptions& options = {});

/// Returns a name such as "stir, mean force", "stir, all cues" or "all hands, all cues".
[[nodiscard]] std::string nameOf(const PerceivedCue& perceived);

/// Weber fraction x84/p - 1 of the participants of icra2021. It depends on the interpretation of the published number,
/// because eq. (22) is printed with two errors.
struct ParticipantsWeberFraction {
  double as_meant = 0;          ///< the number is x84/p - 1, as used in the text of icra2021
  double as_printed = 0;        ///< the number is w of eq. (22) as printed, with the natural logarithm
  double as_printed_log10 = 0;  ///< the number is w of eq. (22) as printed, with the decimal logarithm
};
[[nodiscard]] ParticipantsWeberFraction participantsWeberFraction(std::string_view block);

}  // namespace haptolith

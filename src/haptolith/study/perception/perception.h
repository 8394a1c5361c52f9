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

/// A stimulus of the paper's user study as a scene.
struct PerceptionStimulus {
  std::string name;  ///< "P3", "Moon"
  double x = 0;      ///< friction coefficient, or gravity in m/s^2
  SceneFile scene;
};

/// One of the paper's two experiments with one model of friction, explored.
struct PerceptionBlock {
  std::string name;  ///< "friction" or "gravity"
  FrictionModel friction = FrictionModel::kPaper;
  std::vector<PerceptionStimulus> stimuli;  ///< in the order of their x
  std::size_t reference = 0;                ///< of the stimuli
  /// [stimulus][hand][repeat]
  std::vector<std::vector<std::vector<Exploration>>> explorations = {};
};

struct PerceptionOptions {
  std::vector<std::string> blocks{"friction", "gravity"};
  std::vector<FrictionModel> frictions{FrictionModel::kPaper, FrictionModel::kContact};
  std::vector<Manoeuvre> hands{Manoeuvre::kStir, Manoeuvre::kPress, Manoeuvre::kScoop};
  double contact_cohesion_n = 0;  ///< F_c of soil with contact friction
  int repeats = 15;               ///< explorations of each stimulus by each hand, 2 or more
  int rounds = 2;                 ///< of a manoeuvre in each
  std::uint64_t seed = 1;
  int threads = 1;
};

/// Told how much is done, 0 to 1; false gives up.
using PerceptionProgress = std::function<bool(double share)>;

/// Lets hands explore every stimulus of the paper's user study.
/// @throws Failure when it was given up, and as explore().
[[nodiscard]] std::vector<PerceptionBlock> explorePaperStimuli(const PerceptionOptions& options,
                                                               const PerceptionProgress& progress);

/// What one observer can tell of a block.
struct PerceivedCue {
  std::optional<Manoeuvre> hand = {};     ///< none: all of them, one after the other
  const Cue* cue = nullptr;               ///< null: all of the hand's together
  std::vector<double> means, deviations;  ///< of each stimulus, in the cue's unit; empty where cues are combined
  Discrimination discrimination;
};

struct PerceiveOptions {
  ObserverOptions observer = {.resamplings = 200};
  double sense_scale = 1;  ///< of the Weber fractions and thresholds of all senses, 0.1 to 10: below 1 for finer ones
};

/// Observers of each single cue of each hand, of all cues of each hand, and of all cues of all hands. Cues that a hand
/// never has (what it carries, when it does not lift) are left out.
/// @throws InvalidParameter as discriminate().
[[nodiscard]] std::vector<PerceivedCue> perceive(const PerceptionBlock& block, const std::vector<Manoeuvre>& hands,
                                                 const PerceiveOptions& options = {});

/// "stir, mean force", "stir, all cues", "all hands, all cues".
[[nodiscard]] std::string nameOf(const PerceivedCue& perceived);

/// The Weber fraction x84/p - 1 that the paper's participants showed, which depends on what was fitted to them: the
/// paper gives a number, and (22) with two faults.
struct ParticipantsWeberFraction {
  double as_meant = 0;          ///< the number is x84/p - 1, as the paper's text uses it
  double as_printed = 0;        ///< the number is w of (22) as printed, with the natural logarithm
  double as_printed_log10 = 0;  ///< the same with the decimal one
};
[[nodiscard]] ParticipantsWeberFraction participantsWeberFraction(std::string_view block);

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/scenario/scenario.h"
#include "haptolith/study/exploration.h"
#include "haptolith/study/ideal_observer.h"

namespace haptolith {

/// A stimulus of the paper's user study as a scene.
struct PerceptionStimulus {
  std::string name;  ///< "P3", "Moon"
  double x = 0;      ///< friction coefficient, or gravity in m/s^2
  Scenario scene;
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

/// What one cue of one hand tells about a block.
struct PerceivedCue {
  Manoeuvre hand = Manoeuvre::kStir;
  const Cue* cue = nullptr;
  std::vector<double> means, deviations;  ///< of each stimulus, in the cue's unit
  Discrimination discrimination;
};

/// Cues that a hand never has (what it carries, when it does not lift) are left out.
[[nodiscard]] std::vector<PerceivedCue> perceive(const PerceptionBlock& block, const std::vector<Manoeuvre>& hands);

/// The Weber fraction that the paper's participants showed.
[[nodiscard]] double participantsWeberFraction(std::string_view block);

}  // namespace haptolith

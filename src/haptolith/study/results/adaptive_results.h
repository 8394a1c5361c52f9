#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "haptolith/psychometrics/adaptive/adaptive_procedure.h"
#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/levels.h"
#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// Returns the procedure of an adaptive block before the first response. @param seed  procedureSeed().
/// @throws InvalidParameter for a block with constant stimuli.
[[nodiscard]] std::unique_ptr<AdaptiveProcedure> procedureOf(const StudyBlock& block, std::uint64_t seed);

/// Estimates for one participant in an adaptive block: medians and 95 % intervals of a posterior. For QUEST+ it is the
/// procedure's posterior on a finer grid of thresholds. For staircases it is the posterior of all responses with
/// QUEST+'s defaults. The mean of the reversals is not used, because coarse levels and the ends of the ladder bias it
/// (docs/reports/psychometric-coverage.md has both).
struct AdaptiveResult {
  int trials = 0;         ///< responses that count
  bool finished = false;  ///< whether the procedure has ended; otherwise the estimates are preliminary
  Estimate threshold = {};
  std::optional<Estimate> width = {};           ///< see PsychometricFunction; none for staircases that target equality
  std::optional<Estimate> jnd = {};             ///< x84 - x50 at the threshold's median
  std::optional<Estimate> weber_fraction = {};  ///< x84/x50 - 1, on a logarithmic axis
  std::optional<AdaptiveEstimate> reversals = {};  ///< staircases: mean of the reversals
  std::string remark = {};                         ///< warning that the estimate is at the end of the levels, or empty
};

/// Estimates from the responses of one participant.
/// @param answers  responses in main trials, in their order, each with n = 1.
/// @return none before the first response.
/// @throws InvalidParameter as procedureOf(), and for a response at a value that is not a level of the block.
[[nodiscard]] std::optional<AdaptiveResult> adaptiveResult(const StudyBlock& block, std::uint64_t seed,
                                                           std::span<const Level> answers);

/// Result of one participant in one adaptive block.
struct AdaptiveResultOf {
  std::int64_t participant = 0;  ///< ParticipantRow::id
  std::size_t block = 0;         ///< index in the protocol's blocks
  AdaptiveResult result = {};
};

/// Returns the results of all participants in all adaptive blocks, by participant and block. @param trials  all trials
/// of the study.
[[nodiscard]] std::vector<AdaptiveResultOf> adaptiveResults(const StudyStore& study, std::span<const TrialRow> trials);

}  // namespace haptolith

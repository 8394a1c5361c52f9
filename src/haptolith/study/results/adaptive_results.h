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

/// The procedure of an adaptive block before the first answer. @param seed  procedureSeed().
/// @throws InvalidParameter for a block with constant stimuli.
[[nodiscard]] std::unique_ptr<AdaptiveProcedure> procedureOf(const StudyBlock& block, std::uint64_t seed);

/// What an adaptive block tells of one participant: medians and 95 % intervals of a posterior. With QUEST+ it is the
/// procedure's own, over thresholds that lie closer; with staircases it is that of all their answers with QUEST+'s
/// defaults, for the mean of the reversals is shifted by coarse levels and by the ends of the ladder
/// (docs/reports/psychometric-coverage.md has both).
struct AdaptiveResult {
  int trials = 0;         ///< answers that count
  bool finished = false;  ///< the procedure has ended; otherwise this is so far
  Estimate threshold = {};
  std::optional<Estimate> width = {};           ///< see PsychometricFunction; none of staircases that look for equality
  std::optional<Estimate> jnd = {};             ///< x84 - x50 at the threshold's median
  std::optional<Estimate> weber_fraction = {};  ///< x84/x50 - 1, on a logarithmic axis
  std::optional<AdaptiveEstimate> reversals = {};  ///< of staircases: the mean of their reversals
  std::string remark = {};                         ///< that the estimate lies where the levels end; empty: it does not
};

/// @param answers  to main trials, in their order, each with n = 1.
/// @return none before the first answer.
/// @throws InvalidParameter as procedureOf(), and for an answer to what is no level of the block.
[[nodiscard]] std::optional<AdaptiveResult> adaptiveResult(const StudyBlock& block, std::uint64_t seed,
                                                           std::span<const Level> answers);

/// The result of one participant in one adaptive block.
struct AdaptiveResultOf {
  std::int64_t participant = 0;  ///< ParticipantRow::id
  std::size_t block = 0;         ///< of the protocol's blocks
  AdaptiveResult result = {};
};

/// All there are, by participant and block. @param trials  the study's.
[[nodiscard]] std::vector<AdaptiveResultOf> adaptiveResults(const StudyStore& study, std::span<const TrialRow> trials);

}  // namespace haptolith

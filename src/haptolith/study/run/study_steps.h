#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/protocol/sequence.h"

namespace haptolith {

/// Where a participant is.
enum class StudyPhase {
  kWaiting,       ///< nobody has begun
  kConsent,       ///< reads what will happen, and agrees
  kForm,          ///< answers questions about themselves or the block
  kInstructions,  ///< reads what to do
  kPreparing,     ///< waits for a stimulus
  kInterval,      ///< feels it
  kQuestion,      ///< says what it was like
  kFeedback,      ///< is told whether that was right
  kBreak,
  kFinished,
  kWithdrawn,
  kStopped,  ///< for today
};

/// Whether a trial is under way in this phase, or prepared.
[[nodiscard]] inline bool isTrialPhase(StudyPhase phase) noexcept {
  return phase == StudyPhase::kPreparing || phase == StudyPhase::kInterval || phase == StudyPhase::kQuestion;
}

/// One step of a participant's way: a page, a form, or a block's trials.
struct StudyStep {
  StudyPhase phase = StudyPhase::kInstructions;  ///< kPreparing: a block's trials
  std::string name = {};                         ///< in the store: "consent", "block 0 trials"; empty: not kept
  std::string title = {}, text = {};
  std::size_t position = 0;  ///< of the block in the participant's order
  bool of_block = false;
  const std::vector<FormItem>* form = nullptr;  ///< of the protocol
};

/// A participant's way from the first page to the last. @param protocol  outlives the steps.
[[nodiscard]] std::vector<StudyStep> stepsOf(const StudyProtocol& protocol, std::span<const PlannedBlock> sequence);

}  // namespace haptolith

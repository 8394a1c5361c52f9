#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/protocol/sequence.h"

namespace haptolith {

/// Phase of a participant in the study.
enum class StudyPhase {
  kWaiting,       ///< no participant has begun
  kConsent,       ///< reads the consent text, and agrees
  kForm,          ///< answers demographics or a questionnaire
  kInstructions,  ///< reads the instructions
  kPreparing,     ///< waits for a stimulus
  kInterval,      ///< feels the stimulus
  kQuestion,      ///< responds
  kFeedback,      ///< sees whether the response was correct
  kBreak,
  kFinished,
  kWithdrawn,
  kStopped,  ///< the session has ended; the participant can resume
};

/// Whether a trial is running or prepared in this phase.
[[nodiscard]] inline bool isTrialPhase(StudyPhase phase) noexcept {
  return phase == StudyPhase::kPreparing || phase == StudyPhase::kInterval || phase == StudyPhase::kQuestion;
}

/// One step of a participant: a page, a form, or a block's trials.
struct StudyStep {
  StudyPhase phase = StudyPhase::kInstructions;  ///< kPreparing: a block's trials
  std::string name = {};                         ///< name in the store: "consent", "block 0 trials"; empty: not stored
  std::string title = {}, text = {};
  std::size_t position = 0;  ///< position of the block in the participant's order
  bool of_block = false;
  const std::vector<FormItem>* form = nullptr;  ///< form in the protocol
};

/// Returns the steps of a participant, from the first page to the last. @param protocol  must outlive the steps.
[[nodiscard]] std::vector<StudyStep> stepsOf(const StudyProtocol& protocol, std::span<const PlannedBlock> sequence);

}  // namespace haptolith

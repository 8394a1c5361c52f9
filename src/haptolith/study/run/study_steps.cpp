#include "haptolith/study/run/study_steps.h"

#include <fmt/format.h>

namespace haptolith {

namespace {

std::string blockStep(std::size_t position, std::string_view what) {
  return fmt::format("block {} {}", position, what);
}

}  // namespace

std::vector<StudyStep> stepsOf(const StudyProtocol& protocol, std::span<const PlannedBlock> sequence) {
  std::vector<StudyStep> steps;
  if (!protocol.consent.empty()) {
    steps.push_back(
        {.phase = StudyPhase::kConsent, .name = "consent", .title = protocol.title, .text = protocol.consent});
  }
  if (!protocol.demographics.empty()) {
    steps.push_back({.phase = StudyPhase::kForm,
                     .name = "demographics",
                     .title = "About you",
                     .text = {},
                     .form = &protocol.demographics});
  }
  if (!protocol.instructions.empty()) {
    steps.push_back({.phase = StudyPhase::kInstructions,
                     .name = "instructions",
                     .title = protocol.title,
                     .text = protocol.instructions});
  }
  for (std::size_t position = 0; position < sequence.size(); ++position) {
    const StudyBlock& block = protocol.blocks[sequence[position].block];
    if (!block.instructions.empty()) {
      steps.push_back({.phase = StudyPhase::kInstructions,
                       .name = blockStep(position, "instructions"),
                       .title = block.title,
                       .text = block.instructions,
                       .position = position,
                       .of_block = true});
    }
    steps.push_back({.phase = StudyPhase::kPreparing,
                     .name = blockStep(position, "trials"),
                     .title = block.title,
                     .text = {},
                     .position = position,
                     .of_block = true});
    if (!block.questionnaire.empty()) {
      steps.push_back({.phase = StudyPhase::kForm,
                       .name = blockStep(position, "questionnaire"),
                       .title = block.title,
                       .text = "About the trials that you have just completed.",
                       .position = position,
                       .of_block = true,
                       .form = &block.questionnaire});
    }
  }
  if (!protocol.questionnaire.empty()) {
    steps.push_back({.phase = StudyPhase::kForm,
                     .name = "questionnaire",
                     .title = "About the whole study",
                     .text = {},
                     .form = &protocol.questionnaire});
  }
  return steps;
}

}  // namespace haptolith

#include <CLI/App.hpp>
#include <fmt/format.h>

#include <memory>
#include <string>

#include "haptolith/study/store/participant_flow.h"
#include "haptolith/study/store/store.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/output.h"
#include "study/participant_named.h"

namespace haptolith {

namespace {

constexpr const char* kStudyExcludeExamples = R"(Examples:
  haptolith study exclude friction.study S03 --reason "catch trials"
  haptolith study exclude friction.study S03 --undo --reason "the criterion was another"

Figures and fits leave S03 out; exports mark the rows. No data are deleted. The log of exclusions
keeps every entry.)";

struct ExcludeOptions {
  std::string file, participant, reason;
  bool undo = false;
};

void exclude(const ExcludeOptions& options) {
  StudyStore study(options.file, StudyStore::Access::kRun);
  const ParticipantRow participant = participantNamed(study, options.participant);
  study.setExcluded(participant.id, !options.undo, options.reason);
  printText(
      fmt::format("{}: {}\n{}", participant.code, options.undo ? "no longer excluded" : "excluded", flowsText(study)));
}

}  // namespace

void addStudyExcludeCommand(CLI::App& study) {
  auto options = std::make_shared<ExcludeOptions>();
  CLI::App* command = study.add_subcommand("exclude", "Exclude a participant from figures and fits, with a reason");
  command->footer(kStudyExcludeExamples);
  command->add_option("file", options->file, kStudyFileHelp)->required()->option_text("FILE");
  command->add_option("participant", options->participant, "Code of the participant")->required()->option_text("S03");
  command->add_option("--reason", options->reason, "Reason; stored permanently")->required()->option_text("TEXT");
  command->add_flag("--undo", options->undo, "Undo an exclusion");
  command->callback([options] { exclude(*options); });
}

}  // namespace haptolith

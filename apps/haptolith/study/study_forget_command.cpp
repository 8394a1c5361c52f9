#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/study/store.h"

#include "commands.h"
#include "shared/output.h"

namespace haptolith {

namespace {

constexpr const char* kExamples = R"(Examples:
  haptolith study forget friction.study S03 --personal    what would tell who S03 is; the answers stay
  haptolith study forget friction.study S03               all there is of S03

There is no way back. Recordings, exports and copies of the study are files of their own.)";

struct Options {
  std::string file, participant;
  bool personal = false;
};

ParticipantRow participantOf(const StudyStore& study, const std::string& code) {
  const std::vector<ParticipantRow> participants = study.participants();
  const auto found = std::ranges::find(participants, code, &ParticipantRow::code);
  if (found == participants.end()) {
    std::vector<std::string> codes;
    std::ranges::transform(participants, std::back_inserter(codes), &ParticipantRow::code);
    throw InvalidParameter(
        "participant", fmt::format("'{}'", code),
        codes.empty() ? "a participant; there are none" : fmt::format("one of {}", fmt::join(codes, ", ")));
  }
  return *found;
}

void forget(const Options& options) {
  StudyStore study(options.file, StudyStore::Access::kRun);
  const ParticipantRow participant = participantOf(study, options.participant);
  if (options.personal) {
    const int forgotten = study.forgetPersonal(participant.id);
    printText(fmt::format("{}: {} personal answers deleted\n", participant.code, forgotten));
    return;
  }
  const std::size_t trials = study.trials(participant.id).size();
  study.removeParticipant(participant.id);
  printText(fmt::format("{}: deleted, with {} trials\n", participant.code, trials));
}

}  // namespace

void addStudyForgetCommand(CLI::App& study) {
  auto options = std::make_shared<Options>();
  CLI::App* command = study.add_subcommand("forget", "Delete what the study holds of a participant");
  command->footer(kExamples);
  command->add_option("file", options->file, "A study")->required()->option_text("FILE");
  command->add_option("participant", options->participant, "Whose")->required()->option_text("S03");
  command->add_flag("--personal", options->personal, "Only the answers to personal items");
  command->callback([options] { forget(*options); });
}

}  // namespace haptolith

#include <CLI/App.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/pluralise.h"
#include "haptolith/study/store/store.h"
#include "haptolith/study/store/study_files.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/output.h"
#include "study/participant_named.h"

namespace haptolith {

namespace {

constexpr const char* kStudyForgetExamples = R"(Examples:
  haptolith study forget friction.study S03 --personal               delete only personal answers
  haptolith study forget friction.study S03 --reason "asked for it"  delete all data and recordings

This cannot be undone. The study keeps only the date and the reason of the removal. Exports and
copies of the study are separate files; those in the same folder that name S03 are listed.)";

struct ForgetOptions {
  std::string file, participant, reason;
  bool personal = false, keep_recordings = false;
};

/// Returns the time at which a participant with that code was removed; empty if none was.
std::string removedBefore(const StudyStore& study, const std::string& code) {
  const std::vector<ParticipantRow> participants = study.participants();
  const bool is_there = std::ranges::find(participants, code, &ParticipantRow::code) != participants.end();
  return is_there ? "" : study.removedAt(code);
}

std::string listed(std::string_view heading, const std::vector<std::filesystem::path>& files) {
  std::string text;
  for (const std::filesystem::path& file : files) {
    text += fmt::format("  {}\n", file.string());
  }
  return files.empty() ? "" : fmt::format("{}\n{}", heading, text);
}

std::vector<std::filesystem::path> recordingsOf(const StudyStore& study, const ParticipantRow& participant,
                                                const std::vector<TrialRow>& trials) {
  std::vector<std::string> names(trials.size());
  std::ranges::transform(trials, names.begin(), &TrialRow::recording);
  std::erase(names, "");
  return haptolith::recordingsOf(study.file(), participant.code, names);
}

void forgetEverything(StudyStore& study, const ParticipantRow& participant, const ForgetOptions& options) {
  const std::vector<TrialRow> trials = study.trials(participant.id);
  const std::vector<std::filesystem::path> recordings = recordingsOf(study, participant, trials);
  study.removeParticipant(participant.id, options.reason,
                          options.keep_recordings ? Recordings::kKeep : Recordings::kDelete);
  printText(
      fmt::format("{}: deleted, with {}{}\n{}", participant.code, pluralise(trials.size(), "trial"),
                  options.keep_recordings ? "" : " and " + pluralise(recordings.size(), "recording"),
                  listed("Not deleted, and the code occurs in:", othersThatName(study.file(), participant.code))));
  printText("Exports in other folders, copies and backups must be deleted by hand.\n");
}

void forget(const ForgetOptions& options) {
  StudyStore study(options.file, StudyStore::Access::kRun);
  if (const std::string removed_at = removedBefore(study, options.participant); !removed_at.empty()) {
    printText(fmt::format("{}: already deleted, at {}\n", options.participant, removed_at));
    return;
  }
  const ParticipantRow participant = participantNamed(study, options.participant);
  if (options.personal) {
    const int forgotten = study.forgetPersonal(participant.id, options.reason);
    printText(fmt::format("{}: {} personal answers deleted\n", participant.code, forgotten));
  } else {
    forgetEverything(study, participant, options);
  }
}

}  // namespace

void addStudyForgetCommand(CLI::App& study) {
  auto options = std::make_shared<ForgetOptions>();
  CLI::App* command = study.add_subcommand("forget", "Delete the data of a participant");
  command->footer(kStudyForgetExamples);
  command->add_option("file", options->file, kStudyFileHelp)->required()->option_text("FILE");
  command->add_option("participant", options->participant, "Code of the participant")->required()->option_text("S03");
  CLI::Option* personal =
      command->add_flag("--personal", options->personal, "Delete only the answers to personal items");
  command->add_option("--reason", options->reason, "Reason; stored in the study without the code")->option_text("TEXT");
  command->add_flag("--keep-recordings", options->keep_recordings, "Do not delete the recordings")->excludes(personal);
  command->callback([options] { forget(*options); });
}

}  // namespace haptolith

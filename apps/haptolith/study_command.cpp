#include "study_command.h"

#include <CLI/CLI.hpp>

#include "study_explore_command.h"
#include "study_fit_command.h"
#include "study_run_command.h"

namespace haptolith {

namespace {

constexpr const char* kExamples = R"(Examples:
  haptolith study new friction.study --protocol paper-friction
  haptolith study run friction.study
  haptolith study fit --data answers.csv --sigmoid weber --reference 0.835

Every command explains itself with --help.)";

}  // namespace

void addStudyCommand(CLI::App& app) {
  CLI::App* study = app.add_subcommand("study", "User studies: from the protocol to the psychometric curve");
  study->require_subcommand(1);
  study->footer(kExamples);
  addStudyRunCommands(*study);
  addStudyFitCommand(*study);
  addStudyExploreCommand(*study);
}

}  // namespace haptolith

#include <CLI/App.hpp>

#include "commands.h"

namespace haptolith {

namespace {

constexpr const char* kExamples = R"(Examples:
  haptolith study new friction.study --protocol paper-friction
  haptolith study run friction.study --trial-run
  haptolith study figure friction.study --out friction.svg

Every command explains itself with --help; docs/studies.md tells the whole story.)";

}  // namespace

void addStudyCommand(CLI::App& app) {
  CLI::App* study = app.add_subcommand("study", "User studies: from the protocol to the psychometric curve");
  study->require_subcommand(1);
  study->footer(kExamples);
  addStudyNewCommand(*study);
  addStudyRunCommands(*study);
  addStudyStatusCommand(*study);
  addStudyExportCommand(*study);
  addStudyExcludeCommand(*study);
  addStudyForgetCommand(*study);
  addStudyFigureCommand(*study);
  addStudyFitCommand(*study);
  addStudySimulateCommand(*study);
  addStudyPlanCommand(*study);
  addStudyPreregisterCommand(*study);
  addStudyExploreCommand(*study);
}

}  // namespace haptolith

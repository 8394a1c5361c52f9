#include <CLI/App.hpp>

#include "commands.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

constexpr const char* kStudyExamples = R"(Examples:
  haptolith study new friction.study --protocol icra2021-friction
  haptolith study run friction.study --trial-run
  haptolith study figure friction.study --figure friction.svg

Run a command with --help for its options. Guide: docs/how-to/run-a-study.md)";

}  // namespace

void addStudyCommand(CLI::App& app) {
  CLI::App* study = app.add_subcommand("study", kStudyDescription);
  study->require_subcommand(1);
  study->footer(kStudyExamples);
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
  addStudyIdealObserverCommand(*study);
}

}  // namespace haptolith

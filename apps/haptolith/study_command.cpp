#include "study_command.h"

#include <CLI/CLI.hpp>

#include "study_run_command.h"

namespace haptolith {

void addStudyCommand(CLI::App& app) {
  CLI::App* study = app.add_subcommand("study", "User studies: from protocol to psychometric curve");
  study->require_subcommand(1);
  addStudyRunCommands(*study);
}

}  // namespace haptolith

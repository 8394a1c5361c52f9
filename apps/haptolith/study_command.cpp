#include "study_command.h"

#include "study_export_command.h"
#include "study_new_command.h"
#include "study_status_command.h"

namespace haptolith {

void addStudyCommand(CLI::App& app) {
  CLI::App* study = app.add_subcommand("study", "User studies: from the protocol to the psychometric curve");
  study->require_subcommand(1);
  study->footer("Every command explains itself with --help.");
  addStudyNewCommand(*study);
  addStudyStatusCommand(*study);
  addStudyExportCommand(*study);
}

}  // namespace haptolith

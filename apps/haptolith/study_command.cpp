#include "study_command.h"

#include "study_fit_command.h"

namespace haptolith {

void addStudyCommand(CLI::App& app) {
  CLI::App* study = app.add_subcommand("study", "User studies: from the protocol to the psychometric curve");
  study->require_subcommand(1);
  study->footer(
      "Example:\n  haptolith study fit --data answers.csv --sigmoid weber --reference 0.835\n"
      "Every command explains itself with --help.");
  addStudyFitCommand(*study);
}

}  // namespace haptolith

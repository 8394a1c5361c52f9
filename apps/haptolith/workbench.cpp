// `haptolith-workbench`: every command of the program, including those for laboratory, studies and robots.

#include <CLI/App.hpp>

#include "commands.h"

namespace haptolith {

void addCommands(CLI::App& app) {
  addProgramCommands(app);
  addSoilCalibrateCommand(*app.get_subcommand("soil"));
  addLabCommand(app);
  addTrustCommand(app);
  addStudyCommand(app);
  addIdentifyCommand(app);
  addTeleopCommand(app);
  addRos2Command(app);
  addBenchCommand(app);
  addCompletionCommand(app);
}

void runWhatIsElsewhere(const std::vector<std::string>& /*arguments*/) {}

}  // namespace haptolith

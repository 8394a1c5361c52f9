#include "commands.h"

namespace haptolith {

void addProgramCommands(CLI::App& app) {
  addRunCommand(app);
  addSnapshotCommand(app);
  addReplayCommand(app);
  addExportCommand(app);
  addImportCommand(app);
  addSoilCommands(app);
  addScenesCommand(app);
  addDevicesCommand(app);
  addDoctorCommand(app);
}

}  // namespace haptolith

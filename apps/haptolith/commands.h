#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace haptolith {

// Commands of the program. Each is added by a function below, defined in the file of its name. A command runs during
// parsing of the command line, which throws CLI::ParseError for wrong usage, InvalidParameter for an invalid value, and
// Failure for failed work.

/// Adds all commands of this executable: defined in program.cpp for `haptolith`, in workbench.cpp for
/// `haptolith-workbench`.
void addCommands(CLI::App& app);
/// Replaces this process by the executable that has the command; returns if this one has it.
/// @throws Failure if no executable is found.
void runWhatIsElsewhere(const std::vector<std::string>& arguments);

/// Adds the commands common to both executables.
void addProgramCommands(CLI::App& app);

void addRunCommand(CLI::App& app);
void addSnapshotCommand(CLI::App& app);
void addReplayCommand(CLI::App& app);
void addExportCommand(CLI::App& app);
void addImportCommand(CLI::App& app);
void addSoilCommands(CLI::App& app);
void addScenesCommand(CLI::App& app);
void addLabCommand(CLI::App& app);
void addTrustCommand(CLI::App& app);
void addStudyCommand(CLI::App& app);
void addIdentifyCommand(CLI::App& app);
void addTeleopCommand(CLI::App& app);
void addRos2Command(CLI::App& app);
void addBenchCommand(CLI::App& app);
void addDevicesCommand(CLI::App& app);
void addDoctorCommand(CLI::App& app);
/// Adds `completion bash|zsh|fish`: prints a script generated from the commands and options of `app`.
void addCompletionCommand(CLI::App& app);

/// Adds `soil calibrate` to the commands of addSoilCommands().
void addSoilCalibrateCommand(CLI::App& soil);

// Subcommands of `haptolith lab`.
void addCollect(CLI::App& lab);
void addReport(CLI::App& lab);
void addValidate(CLI::App& lab);
void addBand(CLI::App& lab);

// Subcommands of `haptolith study`.
void addStudyExcludeCommand(CLI::App& study);
void addStudyExportCommand(CLI::App& study);
void addStudyFigureCommand(CLI::App& study);
void addStudyFitCommand(CLI::App& study);
void addStudyForgetCommand(CLI::App& study);
void addStudyIdealObserverCommand(CLI::App& study);
void addStudyNewCommand(CLI::App& study);
void addStudyPlanCommand(CLI::App& study);
void addStudyPreregisterCommand(CLI::App& study);
void addStudyRunCommands(CLI::App& study);  // `run` and `resume`
void addStudySimulateCommand(CLI::App& study);
void addStudyStatusCommand(CLI::App& study);

}  // namespace haptolith

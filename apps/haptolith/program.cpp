// `haptolith`: the commands needed in a first run. The others are in `haptolith-workbench`, which takes twice as long
// to compile. It is located like the commands of git, and built on first use in a build folder.

#include <CLI/App.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/child_process.h"
#include "haptolith/core/platform/files.h"
#include "haptolith/core/platform/this_program.h"

#include "commands.h"
#include "shared/output.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

struct CommandElsewhere {
  std::string_view name;  ///< "soil calibrate": a subcommand of a command that is here
  std::string_view description;
};

constexpr std::array kElsewhere{CommandElsewhere{"lab", kLabDescription},
                                CommandElsewhere{"trust", kTrustDescription},
                                CommandElsewhere{"soil calibrate", kSoilCalibrateDescription},
                                CommandElsewhere{"study", kStudyDescription},
                                CommandElsewhere{"identify", kIdentifyDescription},
                                CommandElsewhere{"teleop", kTeleopDescription},
                                CommandElsewhere{"ros2", kRos2Description},
                                CommandElsewhere{"bench", kBenchDescription},
                                CommandElsewhere{"completion", kCompletionDescription}};

/// Folder of the installed workbench, relative to that of this program.
constexpr const char* kInstalled = HAPTOLITH_WORKBENCH_FROM_PROGRAM;
constexpr const char* kName = "haptolith-workbench";
constexpr std::chrono::hours kMostBuilding{24};

/// Returns the build folder that contains this program; empty if it is installed.
fs::path buildFolder(const fs::path& program) {
  const fs::path folder = program.parent_path().parent_path().parent_path();
  return fs::exists(folder / "build.ninja") ? folder : fs::path();
}

/// Runs ninja, with its output on standard error. @throws Failure.
void build(const fs::path& folder) {
  const Descriptor terminal(copyOf(kStandardError));
  ChildProcess ninja({.arguments = {"ninja", "-C", folder.string(), kName},
                      .package = "ninja-build",
                      .environment = {},
                      .most_cpu = kMostBuilding},
                     {{terminal, kStandardOutput}, {terminal, kStandardError}});
  if (!ninja.wait(kMostBuilding)) {
    throw Failure(fmt::format("cannot build {}; try: ninja -C {} {}", kName, folder.string(), kName));
  }
}

fs::path workbench(std::string_view command) {
  const fs::path program = programFile();
  const std::string name = programFileName(kName);
  for (const fs::path& file : {program.parent_path() / name, program.parent_path() / kInstalled / name}) {
    if (fs::exists(file)) {
      return file;
    }
  }
  const fs::path folder = buildFolder(program);
  if (folder.empty()) {
    throw Failure(fmt::format("haptolith {} is not installed: {} is neither in {} nor in {}; install haptolith again",
                              command, kName, program.parent_path().string(),
                              (program.parent_path() / kInstalled).lexically_normal().string()));
  }
  printNotice(fmt::format("building haptolith {} for its first use, which takes some minutes\n", command));
  build(folder);
  return program.parent_path() / name;
}

/// Whether the command line begins with the words of the command.
bool isAsked(const CommandElsewhere& command, const std::vector<std::string>& arguments) {
  std::string words;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    words += arguments[i];
    words += ' ';
  }
  return words.starts_with(std::string(command.name) + ' ');
}

}  // namespace

void addCommands(CLI::App& app) {
  addProgramCommands(app);
  for (const CommandElsewhere& command : kElsewhere) {
    const std::size_t space = command.name.find(' ');
    const bool is_below = space != std::string_view::npos;
    CLI::App& above = is_below ? *app.get_subcommand(std::string(command.name.substr(0, space))) : app;
    above.add_subcommand(std::string(command.name.substr(is_below ? space + 1 : 0)), std::string(command.description));
  }
}

void runWhatIsElsewhere(const std::vector<std::string>& arguments) {
  const auto* asked =
      std::ranges::find_if(kElsewhere, [&](const CommandElsewhere& command) { return isAsked(command, arguments); });
  if (asked == kElsewhere.end()) {
    return;
  }
  const fs::path file = workbench(asked->name);
  printPosted();
  becomeProgram(file, arguments);
}

}  // namespace haptolith

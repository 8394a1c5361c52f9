// `haptolith`: the commands needed in a first run. The others are in `haptolith-workbench`, which takes twice as long
// to compile. It is located like the commands of git, and built on first use in a build folder.

#include <CLI/App.hpp>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "haptolith/core/error.h"

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

/// Returns the build folder that contains this program; empty if it is installed.
fs::path buildFolder(const fs::path& program) {
  const fs::path folder = program.parent_path().parent_path().parent_path();
  return fs::exists(folder / "build.ninja") ? folder : fs::path();
}

/// Runs ninja with its output on standard error. @throws Failure.
void build(const fs::path& folder) {
  const pid_t child = fork();
  if (child == 0) {
    dup2(STDERR_FILENO, STDOUT_FILENO);
    execlp("ninja", "ninja", "-C", folder.c_str(), kName, nullptr);
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw Failure(fmt::format("cannot build {}; try: ninja -C {} {}", kName, folder.string(), kName));
  }
}

fs::path workbench(std::string_view command) {
  const fs::path program = fs::read_symlink("/proc/self/exe");
  for (const fs::path& file : {program.parent_path() / kName, program.parent_path() / kInstalled / kName}) {
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
  return program.parent_path() / kName;
}

/// Whether the command line begins with the words of the command.
bool isAsked(const CommandElsewhere& command, int argc, char** argv) {
  std::string words;
  for (int i = 1; i < argc; ++i) {
    words += argv[i];
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

void runWhatIsElsewhere(int argc, char** argv) {
  const auto* asked =
      std::ranges::find_if(kElsewhere, [&](const CommandElsewhere& command) { return isAsked(command, argc, argv); });
  if (asked == kElsewhere.end()) {
    return;
  }
  const fs::path file = workbench(asked->name);
  printPosted();
  execv(file.c_str(), argv);
  throw Failure(fmt::format("cannot start {}: {}", file.string(), std::strerror(errno)));
}

}  // namespace haptolith

// `haptolith`: the commands needed in a first run. The others are in `haptolith-workbench`, which takes twice as long
// to compile. It is located like the commands of git, and built on first use in a build folder.

#include <CLI/App.hpp>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "haptolith/core/error.h"

#include "commands.h"
#include "shared/output.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

struct CommandElsewhere {
  std::string_view name, description;
};

constexpr std::array kElsewhere{CommandElsewhere{"lab", kLabDescription},
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

}  // namespace

void addCommands(CLI::App& app) {
  addProgramCommands(app);
  for (const CommandElsewhere& command : kElsewhere) {
    app.add_subcommand(std::string(command.name), std::string(command.description));
  }
}

void runWhatIsElsewhere(int argc, char** argv) {
  const auto is_asked = [&](const CommandElsewhere& command) { return argc > 1 && command.name == argv[1]; };
  if (std::none_of(kElsewhere.begin(), kElsewhere.end(), is_asked)) {
    return;
  }
  const fs::path file = workbench(argv[1]);
  execv(file.c_str(), argv);
  throw Failure(fmt::format("cannot start {}: {}", file.string(), std::strerror(errno)));
}

}  // namespace haptolith

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/bed/start/tile_cache.h"
#include "haptolith/core/error.h"
#include "haptolith/core/former_names.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/platform/descriptor.h"
#include "haptolith/core/platform/terminal.h"
#include "haptolith/core/platform/this_program.h"

#include "commands.h"
#include "shared/former_arguments.h"
#include "shared/help_formatter.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/saved.h"

namespace haptolith {
namespace {

/// Exit status of the program; docs and scripts rely on it.
enum ExitStatus { kOk = 0, kFailed = 1, kUsage = 2 };

constexpr const char* kProgramExamples = R"(Examples:
  haptolith run                          run lunar soil with a virtual hand
  haptolith run icra2021                 run the scene of the ICRA 2021 paper
  haptolith run scenes/rain.toml         run a scene from a file (docs/reference/scenes.md)
  haptolith snapshot --out view.png      save a picture of a scene, without a display
  haptolith soil list                    list the built-in soils and their measured properties
  haptolith lab shear --soil dry-sand    simulate a direct shear test
  haptolith doctor                       check whether this machine runs the loop in real time
  source <(haptolith completion bash)    complete commands with the tab key

Environment:
  HAPTOLITH_SIMD=SSE4     use this instruction set instead of the best that the machine has
  HAPTOLITH_CACHE=FOLDER  keep settled soil in this folder; off: do not keep it

Exit status: 0 success, 1 failure, 2 wrong usage.)";

/// Log sink on standard error that does not wait for a terminal. Control characters are removed, because messages
/// contain texts of files.
class PostingSink final : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string plain = plainText({message.payload.data(), message.payload.size()}, Lines::kSeveral);
    const spdlog::details::log_msg harmless(message.time, message.source, message.logger_name, message.level, plain);
    spdlog::memory_buf_t line;
    formatter_->format(harmless, line);
    std::string text(line.data(), line.size());
    if (coloured_ && harmless.color_range_end > harmless.color_range_start) {
      const bool grave = message.level >= spdlog::level::err;
      text.insert(harmless.color_range_end, "\033[0m");
      text.insert(harmless.color_range_start, grave ? "\033[1;31m" : "\033[1;33m");
    }
    post(std::move(text));
  }
  void flush_() override {}

 private:
  const bool coloured_ = isColoured(kStandardError);
};

void logToStandardError() {
  auto logger = std::make_shared<spdlog::logger>("haptolith", std::make_shared<PostingSink>());
  logger->set_pattern("%n: %^%l%$: %v");
  spdlog::set_default_logger(std::move(logger));
}

void printError(const std::string& message) {
  const bool coloured = isColoured(kStandardError);
  printNotice(
      fmt::format("haptolith: {}error:{} {}\n", coloured ? "\033[1;31m" : "", coloured ? "\033[0m" : "", message));
}

/// Returns the help of the selected command, with its full path in the usage line.
std::string helpOf(const CLI::App& app) {
  const CLI::App* at = &app;
  std::string above;
  while (!at->get_subcommands().empty()) {
    above += (above.empty() ? "" : " ") + at->get_name();
    at = at->get_subcommands().front();
  }
  return at->help(above);
}

/// Returns the command selected by the command line.
const CLI::App& reachedBy(const CLI::App& app) {
  const CLI::App* at = &app;
  while (!at->get_subcommands().empty()) {
    at = at->get_subcommands().front();
  }
  return *at;
}

/// Returns its path, for example "haptolith soil list".
std::string commandPath(const CLI::App& reached) {
  const CLI::App* above = reached.get_parent();
  return above == nullptr ? "haptolith" : commandPath(*above) + " " + reached.get_name();
}

/// Puts the commands into groups of the program's help; docs/make/commands.py reads headings "... commands:".
void groupCommands(CLI::App& app) {
  const std::vector<std::pair<const char*, std::vector<const char*>>> groups{
      {"Run commands", {"run", "snapshot", "devices", "doctor"}},
      {"Record commands", {"replay", "export", "import"}},
      {"Soil commands", {"soil", "lab", "identify", "scenes"}},
      {"Study commands", {"study"}},
      {"Remote commands", {"teleop", "ros2"}},
      {"Developer commands", {"bench", "completion", "version"}}};
  for (const auto& [group, names] : groups) {
    for (const char* name : names) {
      app.get_subcommand(name)->group(group);
    }
  }
}

ExitStatus usageError(const CLI::App& app, const std::string& message) {
  printError(message);
  printNotice(fmt::format("Run '{} --help' for its commands and options.\n", commandPath(reachedBy(app))));
  return kUsage;
}

/// Lists the saved files on standard output; on standard error if a program reads standard output.
void tellWhatWasSaved(const CLI::App& app) {
  const CLI::Option* json = reachedBy(app).get_option_no_throw("--json");
  const std::string saved = savedText();
  json != nullptr && json->count() > 0 ? printNotice(saved) : printText(saved);
}

void warn(std::string_view line) {
  spdlog::warn("{}", line);
}

ExitStatus run(CLI::App& app, int argc, char** argv) {
  try {
    useTileCache(tileFolder(), warn);
    useSimdTargetOfEnvironment();
    app.parse(argc, argv);
    tellWhatWasSaved(app);
    printText("");  // flushes the output, because a full disk may fail only there
    return kOk;
  } catch (const CLI::CallForHelp&) {
    printText(helpOf(app));
    return kOk;
  } catch (const CLI::CallForVersion& version) {
    printText(std::string(version.what()) + '\n');
    return kOk;
  } catch (const CLI::ParseError& error) {
    if (argc == 1) {
      printNotice(fmt::format("{}\n", app.help()));
    }
    return usageError(app, usageProblem(reachedBy(app), error));
  } catch (const InvalidParameter& error) {
    return usageError(app, error.what());
  } catch (...) {
    printNotice(savedText());
    throw;
  }
}

}  // namespace
}  // namespace haptolith

int main(int argc, char** argv) {
  using namespace haptolith;
  makeClosedPipesErrors();
  prepareTerminals();
  try {
    logToStandardError();
    onFormerName(warn);
    std::vector<std::string> arguments = currentArguments(programArguments(argc, argv));
    runWhatIsElsewhere(arguments);
    std::vector<char*> pointers;
    std::ranges::transform(arguments, std::back_inserter(pointers), [](std::string& text) { return text.data(); });
    pointers.push_back(nullptr);
    argc = static_cast<int>(arguments.size());
    argv = pointers.data();
    CLI::App app{"haptolith: lunar and planetary soil simulated and rendered on a haptic device at 1 kHz", "haptolith"};
    app.set_version_flag("-V,--version", "haptolith " HAPTOLITH_VERSION, "Print the version");
    app.formatter(std::make_shared<HelpFormatter>());
    app.require_subcommand(1);
    app.footer(kProgramExamples);
    addCommands(app);
    app.add_subcommand("version", "Print the version")->callback([] {
      printText("haptolith " HAPTOLITH_VERSION "\n");
    });
    groupCommands(app);
    groupOptions(app);
    return run(app, argc, argv);
  } catch (const std::filesystem::filesystem_error& error) {
    printError(fmt::format("cannot open {}: {}", error.path1().string(), error.code().message()));
    return kFailed;
  } catch (const std::exception& error) {
    printError(error.what());
    return kFailed;
  }
}

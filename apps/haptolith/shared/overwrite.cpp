#include "shared/overwrite.h"

#include <CLI/App.hpp>
#include <CLI/Error.hpp>
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>

#include "shared/option_checks.h"

namespace haptolith {

namespace {

/// Options of all commands that name an output file.
constexpr std::array kOutputs = {"--out", "--soil-out", "--csv", "--trace", "--figure", "--weber-figure", "--record"};

/// Checks output names. @throws CLI::ValidationError if two options name one file, because the second would overwrite
/// the first; also for `-`, which other programs use for standard output.
void requireNames(const CLI::App& command) {
  std::map<std::filesystem::path, std::string> named;
  for (const char* name : kOutputs) {
    const CLI::Option* option = command.get_option_no_throw(name);
    if (option == nullptr || option->count() == 0 || option->results().front().empty()) {
      continue;
    }
    const std::string& file = option->results().front();
    std::string text = file;
    if (const std::string wrong = outputName()(text); !wrong.empty()) {
      throw CLI::ValidationError(fmt::format("{}: {}", name, wrong));
    }
    std::error_code ignored;
    std::filesystem::path path = std::filesystem::weakly_canonical(std::filesystem::absolute(file, ignored), ignored);
    const auto [before, is_new] = named.emplace(path.empty() ? std::filesystem::path(file) : path, name);
    if (!is_new) {
      throw CLI::ValidationError(
          fmt::format("{} and {} name the same file, {}: use two names", before->second, name, file));
    }
  }
}

}  // namespace

void Overwrite::addTo(CLI::App& command) {
  command.add_flag("--overwrite", allowed, "Replace existing output files");
  command.parse_complete_callback([&command] { requireNames(command); });
}

}  // namespace haptolith

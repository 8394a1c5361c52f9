#pragma once

#include <CLI/App.hpp>
#include <CLI/Formatter.hpp>

#include <string>

namespace haptolith {

/// Prints for each option the value that it takes, its range and its default ("--friction-model contact|icra2021",
/// "--threads N ... 1 to 256 [all]") instead of CLI11's ENUM, TEXT, FLOAT and "=1", wrapped to kHelpColumns. The
/// option_text() of an option takes precedence.
class HelpFormatter final : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
};

/// Columns of a line of help.
inline constexpr std::size_t kHelpColumns = 100;

/// Puts the options of long commands into groups: scene, output, browser and so on. Call after all commands are added.
void groupOptions(CLI::App& app);

}  // namespace haptolith

#include "shared/former_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <sstream>
#include <string_view>

#include "haptolith/core/former_names.h"

namespace haptolith {

namespace {

/// A command of version 0.2 and earlier; version 0.4 no longer needs these.
struct FormerCommand {
  std::string_view former, current;  ///< may end with an option
};

struct FormerOption {
  std::string_view command;          ///< first words of the commands of today that have it; empty: any command
  std::string_view former, current;  ///< may end with a value: "--pair-style=haptolith"
};

constexpr std::array kFormerCommands{
    FormerCommand{"lab calibrate", "soil calibrate"},
    FormerCommand{"soil presets", "soil icra2021 list"},
    FormerCommand{"soil profile", "soil icra2021 profile"},
    FormerCommand{"soil calibrate-paper", "soil icra2021 calibrate"},
    FormerCommand{"lab funnel", "lab hopper"},
    FormerCommand{"lab fall", "lab free-fall"},
    FormerCommand{"lab carry", "lab payload"},
    FormerCommand{"lab cut", "lab vertical-cut"},
    FormerCommand{"lab grain", "lab grain-size"},
    FormerCommand{"teleop remote", "teleop robot"},
    FormerCommand{"teleop profiles", "teleop link --list"},
    FormerCommand{"identify check", "identify evaluate"},
    FormerCommand{"study explore", "study ideal-observer"},
};

constexpr std::array kFormerOptions{
    FormerOption{"", "--friction", "--friction-model"},
    FormerOption{"", "--hand", "--motion"},
    FormerOption{"", "--finest", "--auto-resolution"},
    FormerOption{"", "--unpaced", "--no-realtime"},
    FormerOption{"bench", "--seconds", "--duration-s"},
    FormerOption{"doctor", "--seconds", "--duration-s"},
    FormerOption{"devices", "--library", "--device-library"},
    FormerOption{"export", "--run-s", "--duration-s"},
    FormerOption{"export", "--own-law", "--pair-style=haptolith"},
    FormerOption{"import", "--picture", "--frame"},
    FormerOption{"identify next", "--check", "--evaluate"},
    FormerOption{"identify next", "--wanted", "--target-width"},
    FormerOption{"study export", "--to", "--out"},
    FormerOption{"study figure", "--out", "--figure"},
    FormerOption{"study plan", "--against", "--alternative"},
    FormerOption{"study plan", "--people", "--find-n"},
    FormerOption{"study plan", "--spread", "--between-sd"},
    FormerOption{"study simulate", "--spread", "--between-sd"},
    FormerOption{"teleop bench", "--lets-go-s", "--release-s"},
    FormerOption{"teleop", "--to", "--connect"},
};

void report(std::string_view former, std::string_view current) {
  reportFormerName(fmt::format("{} is now {}; the old name works until version 0.4", former, current));
}

std::vector<std::string> wordsOf(std::string_view text) {
  std::istringstream stream{std::string(text)};
  return {std::istream_iterator<std::string>(stream), {}};
}

/// Whether the arguments after the program begin with these words.
bool beginsWith(const std::vector<std::string>& arguments, const std::vector<std::string>& words) {
  return arguments.size() > words.size() && std::equal(words.begin(), words.end(), arguments.begin() + 1);
}

void replaceCommand(std::vector<std::string>& arguments) {
  for (const auto& [former, current] : kFormerCommands) {
    const std::vector<std::string> words = wordsOf(former);
    if (beginsWith(arguments, words)) {
      const auto after = arguments.erase(arguments.begin() + 1, arguments.begin() + 1 + std::ssize(words));
      const std::vector<std::string> today = wordsOf(current);
      arguments.insert(after, today.begin(), today.end());
      report(former, current);
      return;
    }
  }
}

/// "--hand" or "--hand=stir" -> "--motion" or "--motion=stir".
void replaceOption(std::string& argument, const FormerOption& option) {
  const bool has_value = argument.size() > option.former.size() && argument[option.former.size()] == '=';
  if (argument.starts_with(option.former) && (has_value || argument.size() == option.former.size())) {
    argument.replace(0, option.former.size(), option.current);
    report(option.former, option.current);
  }
}

}  // namespace

std::vector<std::string> currentArguments(std::vector<std::string> arguments) {
  replaceCommand(arguments);
  for (const FormerOption& option : kFormerOptions) {
    if (beginsWith(arguments, wordsOf(option.command))) {
      for (std::string& argument : arguments) {
        replaceOption(argument, option);
      }
    }
  }
  return arguments;
}

}  // namespace haptolith

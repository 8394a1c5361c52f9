#include "shared/option_checks.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>

#include "haptolith/core/nearest_word.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/scene_file/toml/file_keys.h"

namespace haptolith {

namespace {

template <class Number>
std::optional<Number> parsed(const std::string& text) {
  Number value{};
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(begin, end, value);
  return error == std::errc() && at == end ? std::optional(value) : std::nullopt;
}

std::string notValid(const std::string& value, const std::string& valid) {
  return fmt::format("{} is not valid: must be {}", value, valid);
}

std::string suggestion(const std::string& word, const std::vector<std::string>& words) {
  const std::vector<std::string_view> candidates(words.begin(), words.end());
  const std::string_view nearest = nearestWord(word, candidates);
  return nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest);
}

std::string listed(const std::vector<std::string>& words) {
  return anyOf({words.begin(), words.end()});
}

const CLI::App& programOf(const CLI::App& command) {
  return command.get_parent() == nullptr ? command : programOf(*command.get_parent());
}

std::vector<std::string> commandsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!command->get_group().empty()) {
      names.push_back(command->get_name());
    }
  }
  return names;
}

/// Returns the message for an unknown word: "unknown option '--duration'; did you mean --duration-s?".
std::string unknownWord(const CLI::App& reached, const std::string& word) {
  if (word.starts_with('-')) {
    std::vector<std::string> options;
    for (const CLI::Option* option : reached.get_options()) {
      for (const std::string& name : option->get_lnames()) {
        options.push_back("--" + name);
      }
    }
    return fmt::format("unknown option '{}'{}", word, suggestion(word.substr(0, word.find('=')), options));
  }
  const std::vector<std::string> commands = commandsOf(reached);
  if (commands.empty()) {
    return fmt::format("unexpected argument '{}'", word);
  }
  const std::string near = suggestion(word, commands);
  return fmt::format("unknown command '{}'{}", word, near.empty() ? ": must be " + listed(commands) : near);
}

/// Returns the valid values of an option, by its type.
std::string validFor(const CLI::App& reached, const std::string& option_name) {
  const CLI::Option* option = reached.get_option_no_throw(option_name);
  const std::string type = option == nullptr ? "" : option->get_type_name();
  return type.starts_with("FLOAT")  ? "a number"
         : type.starts_with("UINT") ? "a whole number, 0 or more"
         : type.starts_with("INT")  ? "a whole number"
                                    : "a value of its kind";
}

}  // namespace

std::string notAmong(const std::vector<std::string>& words, const std::string& word) {
  return notValid(inQuotes(word), listed(words)) + suggestion(word, words);
}

CLI::Validator numberIn(const Range& range) {
  const auto check = [range](const std::string& text) -> std::string {
    const std::optional<double> value = parsed<double>(text);
    return !value                                              ? notValid(inQuotes(text), "a number, " + range.text())
           : !std::isfinite(*value) || !range.contains(*value) ? notValid(text, range.text())
                                                               : "";
  };
  return {check, range.text()};
}

CLI::Validator outputName() {
  const auto check = [](const std::string& text) -> std::string {
    return text != "-" ? ""
                       : notValid("'-'", "a file name; standard output is not supported, and ./- is a file named -");
  };
  return {check, ""};
}

CLI::Validator wholeNumberIn(const Range& range) {
  const auto check = [range](const std::string& text) -> std::string {
    const std::optional<std::int64_t> value = parsed<std::int64_t>(text);
    return value && range.contains(static_cast<double>(*value))
               ? ""
               : notValid(parsed<double>(text) ? text : inQuotes(text), "a whole number, " + range.text());
  };
  return {check, range.text()};
}

CLI::Validator oneOf(const std::vector<std::string>& words) {
  const auto check = [words](const std::string& text) -> std::string {
    return std::ranges::find(words, text) == words.end() ? notAmong(words, text) : "";
  };
  return {check, CLI::detail::generate_set(words)};
}

std::string usageProblem(const CLI::App& reached, const CLI::ParseError& error) {
  std::string text = error.what();
  if (const bool no_command = error.get_name() == "RequiredError" && text.starts_with("A subcommand");
      no_command || error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError)) {
    if (const auto left = programOf(reached).remaining(true); !left.empty()) {
      return unknownWord(reached, left.front());
    }
    if (!no_command) {  // "... not expected: 3 --gravity": CLI11 reverses the order
      return unknownWord(reached, text.substr(text.rfind(' ') + 1));
    }
    return "a command is missing: must be " + listed(commandsOf(reached));
  }
  if (constexpr std::string_view kBegin = "Could not convert: "; text.starts_with(kBegin)) {
    const std::string assignment = text.substr(kBegin.size());
    const std::size_t equals = assignment.find(" = ");
    const std::string name = assignment.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : assignment.substr(equals + 3);
    return fmt::format("{}: {}", name, notValid("'" + value + "'", validFor(reached, name)));
  }
  if (text.ends_with(" missing") && error.get_name() == "ArgumentMismatch") {
    return text.substr(0, text.find(':')) + " needs a value";
  }
  if (const std::size_t at = text.find(" excludes "); at != std::string::npos && error.get_name() == "ExcludesError") {
    return fmt::format("{} and {} cannot both be given", text.substr(0, at),
                       text.substr(at + std::string_view(" excludes ").size()));
  }
  if (const CLI::Option* option = reached.get_option_no_throw(text.substr(0, text.find(' ')));
      option != nullptr && error.get_name() == "RequiredError" &&
      option->get_option_text().find('|') != std::string::npos) {
    return fmt::format("{}: {}", text, option->get_option_text());
  }
  return text;
}

}  // namespace haptolith

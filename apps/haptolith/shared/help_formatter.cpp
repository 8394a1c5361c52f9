#include "shared/help_formatter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace haptolith {

namespace {

/// Type of an option. CLI11 stores the valid values as text after the type: "TEXT:{press,stir}", "INT:1 to 256".
struct Kind {
  std::string type;
  std::string choices;  ///< "press|stir"; empty: any
  std::string range;    ///< "1 to 256"; empty: any
};

Kind kindOf(const CLI::Option& option) {
  const std::string text = option.get_type_name();
  const std::size_t colon = std::min(text.find(':'), text.size());
  Kind kind{.type = text.substr(0, colon), .choices = {}, .range = text.substr(std::min(colon + 1, text.size()))};
  if (kind.range.starts_with('{')) {
    kind.choices = kind.range.substr(1, kind.range.find('}') - 1);
    std::ranges::replace(kind.choices, ',', '|');
    kind.range.clear();
  }
  return kind;
}

/// Returns the metavar of an option; options of one name have the same metavar in every command.
std::string wordFor(const CLI::Option& option, const Kind& kind) {
  struct Named {
    std::string_view option, word;
  };
  constexpr std::array kNamed{
      Named{"soil", "NAME|FILE"},    Named{"scene", "NAME|FILE"},   Named{"preset", "NAME"},
      Named{"body", "NAME"},         Named{"block", "NAME"},        Named{"only", "NAME"},
      Named{"FILES", "FILE"},        Named{"name", "NAME"},         Named{"figure", "FILE"},
      Named{"trace", "FILE"},        Named{"csv", "FILE"},          Named{"data", "FILE"},
      Named{"claims", "FILE"},       Named{"out", "PATH"},          Named{"weber-figure", "FILE"},
      Named{"lapse", "NUMBER|free"}, Named{"guess", "NUMBER|free"}, Named{"overdispersion", "NUMBER|free"}};
  if (!kind.choices.empty()) {
    return kind.choices;
  }
  if (kind.type == "FLOAT") {
    return "NUMBER";
  }
  if (kind.type == "INT" || kind.type == "UINT") {
    return "N";
  }
  const auto named = std::ranges::find_if(kNamed, [&](const Named& known) {
    return option.check_name((option.get_positional() ? "" : "--") + std::string(known.option));
  });
  return named == kNamed.end() ? kind.type : std::string(named->word);
}

/// Whether options are a flag and its negation, whose mutual exclusion is not printed.
bool areOpposites(const CLI::Option& a, const CLI::Option& b) {
  const std::string& one = a.get_single_name();
  const std::string& other = b.get_single_name();
  return one == "no-" + other || other == "no-" + one;
}

/// Characters of UTF-8 text.
std::size_t widthOf(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }));
}

/// "  name   description", the description wrapped and indented by `indent` columns.
std::string entry(const std::string& name, const std::string& description, std::size_t indent) {
  std::string text = "  " + name;
  std::size_t column = widthOf(text);
  const auto break_line = [&] {
    text += '\n' + std::string(indent, ' ');
    column = indent;
  };
  if (column >= indent) {
    break_line();
  } else {
    text += std::string(indent - column, ' ');
    column = indent;
  }
  for (const std::string& word : CLI::detail::split(description, ' ')) {
    const std::size_t width = widthOf(word);
    if (column > indent && column + 1 + width > kHelpColumns) {
      break_line();
    }
    text += (column > indent ? " " : "") + word;
    column += width + (column > indent ? 1 : 0);
  }
  return text + '\n';
}

using Names = std::vector<const char*>;

/// Groups of options; an option of a name is in the same group in every command.
const std::vector<std::pair<const char*, Names>>& optionGroups() {
  static const std::vector<std::pair<const char*, Names>> kGroups{
      {"Soil and scene",
       {"--set", "--preset", "--soil", "--friction-model", "--body", "--auto-resolution", "--coarser",
        "--measure-again", "--model", "--site", "--set-site", "--radius-mm", "--stiffness-n-m"}},
      {"Hand and device",
       {"--motion", "--poses", "--device", "--device-id", "--device-library", "--device-address", "--device-key-file",
        "--device-insecure"}},
      {"Link",
       {"--profile", "--round-trip-s", "--jitter-ms", "--loss", "--burst-loss", "--rate-kbit-s", "--outage",
        "--delays-up", "--delays-down", "--connect", "--list", "--listen", "--key-file", "--insecure", "--silence-s"}},
      {"Robot",
       {"--robot", "--target-topic", "--pose-topic", "--wrench-topic", "--wrench-of-tool", "--target-period-s",
        "--robot-timeout-s", "--max-force-n", "--stop-force-n", "--max-speed-m-s", "--learn", "--no-learn", "--mend",
        "--no-mend"}},
      {"ROS 2", {"--node-name", "--ros-namespace", "--domain", "--localhost", "--target-timeout-s", "--surface-hz"}},
      {"Run", {"--duration-s", "--no-realtime", "--threads", "--cpu", "--seed", "--seeds", "--resume"}},
      {"Picture",
       {"--at-s", "--width", "--height", "--view", "--drawing", "--colour", "--theme", "--panels", "--no-panels",
        "--film", "--fps", "--require-in-time"}},
      {"Output",
       {"--out", "--trace", "--figure", "--weber-figure", "--csv", "--x-label", "--record", "--record-frames",
        "--overwrite", "--json"}},
      {"Browser view",
       {"--serve", "--no-serve", "--port", "--bind", "--token", "--token-file", "--participant-token", "--read-only"}}};
  return kGroups;
}

bool isShown(const CLI::Option* option) {
  return !option->get_group().empty();
}

}  // namespace

void groupOptions(CLI::App& app) {
  constexpr std::size_t kFewOptions = 12;
  for (CLI::App* command : app.get_subcommands({})) {
    groupOptions(*command);
  }
  if (app.get_options(isShown).size() <= kFewOptions) {
    return;
  }
  for (const auto& [group, names] : optionGroups()) {
    std::vector<CLI::Option*> members;
    for (const char* name : names) {
      if (CLI::Option* option = app.get_option_no_throw(name); option != nullptr && isShown(option)) {
        members.push_back(option);
      }
    }
    if (members.size() > 1) {  // a single option stays among the others
      for (CLI::Option* option : members) {
        option->group(group);
      }
    }
  }
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  std::string help = CLI::Formatter::make_help(app, std::move(name), mode);
  constexpr std::string_view kEmptyLines = "\n\n\n";  // between groups of options
  for (std::size_t at = help.find(kEmptyLines); at != std::string::npos; at = help.find(kEmptyLines)) {
    help.erase(at, 1);
  }
  return help;
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  return entry(make_option_name(option, is_positional) + make_option_opts(option), make_option_desc(option),
               get_column_width());
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  return entry(command->get_display_name(true), command->get_description(), get_column_width());
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  if (!option->get_option_text().empty()) {
    return " " + option->get_option_text();
  }
  if (option->get_type_size() == 0) {
    return "";
  }
  const bool several = option->get_expected_max() == CLI::detail::expected_max_vector_size;
  return fmt::format(" {}{}", wordFor(*option, kindOf(*option)),
                     !several                         ? ""
                     : option->get_delimiter() == ',' ? ",..."
                                                      : " ...");
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
  std::string text = option->get_description();
  const bool takes_value = option->get_type_size() != 0;
  if (const std::string range = kindOf(*option).range;
      takes_value && option->get_option_text().empty() && text.find(range) == std::string::npos) {
    const std::size_t usual = text.ends_with(']') ? text.rfind(" [") : std::string::npos;
    text.insert(std::min(usual, text.size()), (text.empty() ? "" : ", ") + range);
  }
  if (std::string usual = option->get_default_str(); takes_value && !usual.empty() && !text.ends_with(']')) {
    if (usual.starts_with('[') && usual.ends_with(']')) {  // several values
      usual = usual.substr(1, usual.size() - 2);
    }
    text += fmt::format(" [{}]", usual);
  }
  if (takes_value && option->get_required() && !option->get_positional()) {
    text += "; required";
  }
  std::vector<std::string> rivals;
  for (const CLI::Option* other : option->get_excludes()) {
    if (!areOpposites(*option, *other)) {
      rivals.push_back(other->get_name());
    }
  }
  std::ranges::sort(rivals);
  if (!rivals.empty() && option->get_option_text().empty()) {
    text += fmt::format("; not with {}", fmt::join(rivals, ", "));
  }
  return text;
}

}  // namespace haptolith

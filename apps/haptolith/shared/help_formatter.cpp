#include "shared/help_formatter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>
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

}  // namespace

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

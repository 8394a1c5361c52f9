#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/presets.h"
#include "haptolith/study/protocol/protocol.h"

#include "commands.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

using Words = std::vector<std::string>;

/// Option, flag or positional argument for a shell.
struct Argument {
  Words names;    ///< "-h", "--help"; empty when positional
  Words choices;  ///< valid values; empty: any, for example a file
  std::string description;
  bool takes_value = false;
};

/// Command of the tree; the root is the program.
struct Command {
  std::string path;  ///< "haptolith soil icra2021 list"
  std::string description;
  std::vector<Command> subcommands;
  std::vector<Argument> arguments;
};

// --- from CLI11 to the tree -----------------------------------------------------------------------------------------

/// First sentence of a description.
std::string summaryOf(const std::string& text) {
  return text.substr(0, std::min(text.find('\n'), text.find(". ")));
}

/// Splits "a,b->1" of CLI11's "{a,b->1}" into {"a", "b"}.
Words splitChoices(const std::string& description) {
  const std::size_t begin = description.find('{');
  const std::size_t end = description.find('}', begin);
  if (begin == std::string::npos || end == std::string::npos) {
    return {};
  }
  Words choices = CLI::detail::split(description.substr(begin + 1, end - begin - 1), ',');
  for (std::string& choice : choices) {
    choice.resize(std::min(choice.find("->"), choice.size()));
  }
  return choices;
}

template <class Table>
Words namedIn(const Table& table) {
  Words names;
  for (const auto& entry : table) {
    names.emplace_back(entry.name);
  }
  return names;
}

/// Returns the choices of an option. CLI11 stores them only as text, in the type name. The library checks soils and
/// bodies, so their options are the same in every command.
Words choicesOf(const CLI::Option& option) {
  if (option.check_lname("preset")) {
    return namedIn(presets());
  }
  if (option.check_lname("soil")) {
    return soilNames();
  }
  if (option.check_lname("body")) {
    return namedIn(bodies());
  }
  if (option.check_lname("protocol")) {
    const auto names = protocolNames();
    return {names.begin(), names.end()};
  }
  if (option.get_name() == "scenario") {
    return sceneNames();
  }
  return splitChoices(option.get_type_name());
}

Argument argumentOf(const CLI::Option& option) {
  Argument argument;
  for (const std::string& name : option.get_snames()) {
    argument.names.push_back("-" + name);
  }
  for (const std::string& name : option.get_lnames()) {
    argument.names.push_back("--" + name);
  }
  argument.choices = choicesOf(option);
  argument.description = summaryOf(option.get_description());
  argument.takes_value = option.get_items_expected_max() > 0;
  return argument;
}

Command commandOf(const CLI::App& app, const std::string& path) {
  Command command{path, summaryOf(app.get_description()), {}, {}};
  for (const CLI::App* subcommand : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!subcommand->get_name().empty() && !subcommand->get_group().empty()) {
      command.subcommands.push_back(commandOf(*subcommand, path + " " + subcommand->get_name()));
    }
  }
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) {
      command.arguments.push_back(argumentOf(*option));
    }
  }
  return command;
}

// --- from the tree to a shell ---------------------------------------------------------------------------------------

using Visit = std::function<void(const Command&)>;

void forEach(const Command& command, const Visit& visit) {
  visit(command);
  for (const Command& subcommand : command.subcommands) {
    forEach(subcommand, visit);
  }
}

std::string lastWord(const std::string& path) {
  return path.substr(path.rfind(' ') + 1);
}

/// Quotes for a shell. Fish interprets \' and \\ between single quotes, the others do not.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return out + "'";
}

/// Returns 'haptolith soil'|'haptolith soil list'|...: every path except the program's.
std::string pathPattern(const Command& root) {
  Words paths;
  forEach(root, [&](const Command& command) {
    if (command.path != root.path) {
      paths.push_back(quoted(command.path));
    }
  });
  return fmt::format("{}", fmt::join(paths, "|"));
}

/// Returns the valid words at the cursor in this command: subcommands, options, choices of positional arguments.
Words wordsOf(const Command& command) {
  Words words;
  for (const Command& subcommand : command.subcommands) {
    words.push_back(lastWord(subcommand.path));
  }
  for (const Argument& argument : command.arguments) {
    const Words& more = argument.names.empty() ? argument.choices : argument.names;
    words.insert(words.end(), more.begin(), more.end());
  }
  return words;
}

/// Calls visit("'haptolith run --motion'|...", choices) for every option that takes a value.
void forEachValue(const Command& root, const std::function<void(const std::string&, const Words&)>& visit) {
  forEach(root, [&](const Command& command) {
    for (const Argument& argument : command.arguments) {
      if (argument.takes_value && !argument.names.empty()) {
        Words patterns;
        for (const std::string& name : argument.names) {
          patterns.push_back(quoted(command.path + " " + name));
        }
        visit(fmt::format("{}", fmt::join(patterns, "|")), argument.choices);
      }
    }
  });
}

std::string bashScript(const Command& root) {
  std::string script = fmt::format(R"(# bash completion for haptolith: source <(haptolith completion bash)
_haptolith() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} at=haptolith i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$at ${{COMP_WORDS[i]}}" in
      {}) at+=" ${{COMP_WORDS[i]}}" ;;
    esac
  done
  case "$at ${{COMP_WORDS[COMP_CWORD - 1]}}" in
)",
                                   pathPattern(root));
  forEachValue(root, [&](const std::string& pattern, const Words& choices) {
    // Without choices the reply is empty, so bash offers files.
    script += choices.empty() ? fmt::format("    {}) return ;;\n", pattern)
                              : fmt::format("    {}) mapfile -t COMPREPLY < <(compgen -W {} -- \"$cur\"); return ;;\n",
                                            pattern, quoted(fmt::format("{}", fmt::join(choices, " "))));
  });
  script += "  esac\n  case \"$at\" in\n";
  forEach(root, [&](const Command& command) {
    script += fmt::format("    {}) mapfile -t COMPREPLY < <(compgen -W {} -- \"$cur\") ;;\n", quoted(command.path),
                          quoted(fmt::format("{}", fmt::join(wordsOf(command), " "))));
  });
  return script + "  esac\n}\ncomplete -o default -F _haptolith haptolith\n";
}

/// Returns an entry of zsh's _describe: 'word:description'.
std::string described(std::string word, const std::string& description) {
  return quoted(CLI::detail::find_and_replace(std::move(word), ":", "\\:") + ":" + description);
}

std::string zshScript(const Command& root) {
  std::string script = fmt::format(R"(#compdef haptolith
# zsh completion for haptolith: source <(haptolith completion zsh)
_haptolith() {{
  local at=haptolith i
  local -a entries
  for ((i = 2; i < CURRENT; i++)); do
    case "$at ${{words[i]}}" in
      {}) at+=" ${{words[i]}}" ;;
    esac
  done
  case "$at ${{words[CURRENT - 1]}}" in
)",
                                   pathPattern(root));
  forEachValue(root, [&](const std::string& pattern, const Words& choices) {
    script += choices.empty() ? fmt::format("    {}) _files; return ;;\n", pattern)
                              : fmt::format("    {}) compadd -- {}; return ;;\n", pattern, fmt::join(choices, " "));
  });
  script += "  esac\n  case \"$at\" in\n";
  forEach(root, [&](const Command& command) {
    Words entries;
    for (const Command& subcommand : command.subcommands) {
      entries.push_back(described(lastWord(subcommand.path), subcommand.description));
    }
    for (const Argument& argument : command.arguments) {
      for (const std::string& word : argument.names.empty() ? argument.choices : argument.names) {
        entries.push_back(described(word, argument.description));
      }
    }
    script += fmt::format("    {}) entries=({}) ;;\n", quoted(command.path), fmt::join(entries, " "));
  });
  return script + R"(  esac
  _describe haptolith entries || _files
}
if [[ ${funcstack[1]-} == _haptolith ]]; then _haptolith "$@"; else compdef _haptolith haptolith; fi
)";
}

std::string fishScript(const Command& root) {
  std::string script = R"(# fish completion for haptolith: haptolith completion fish | source
function __haptolith_at
  set -l at haptolith
  for word in (commandline -opc)[2..-1]
    switch "$at $word"
)";
  forEach(root, [&](const Command& command) {
    if (command.path != root.path) {
      script += fmt::format("      case {}\n        set at \"$at $word\"\n", quoted(command.path));
    }
  });
  script += "    end\n  end\n  test \"$at\" = \"$argv\"\nend\n";
  forEach(root, [&](const Command& command) {
    const std::string here = fmt::format("complete -c haptolith -n \"__haptolith_at {}\"", command.path);
    for (const Command& subcommand : command.subcommands) {
      script += fmt::format("{} -f -a {} -d {}\n", here, lastWord(subcommand.path), quoted(subcommand.description));
    }
    for (const Argument& argument : command.arguments) {
      std::string line = here;
      for (const std::string& name : argument.names) {
        line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      }
      if (argument.takes_value && !argument.names.empty()) {
        line += argument.choices.empty() ? " -r" : " -x";
      }
      if (!argument.choices.empty()) {
        line += argument.names.empty() ? " -f" : "";
        line += " -a " + quoted(fmt::format("{}", fmt::join(argument.choices, " ")));
      }
      script += fmt::format("{} -d {}\n", line, quoted(argument.description));
    }
  });
  return script;
}

}  // namespace

void addCompletionCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("completion", kCompletionDescription);
  auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "Shell")->required()->check(oneOf({"bash", "zsh", "fish"}));
  command->footer("Examples:\n  source <(haptolith completion bash)\n  haptolith completion fish | source");
  command->callback([&app, shell] {
    const Command root = commandOf(app, "haptolith");
    printText(*shell == "bash" ? bashScript(root) : *shell == "zsh" ? zshScript(root) : fishScript(root));
  });
}

}  // namespace haptolith

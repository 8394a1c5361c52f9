#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <string>

#include "haptolith/scenario/scenario.h"

#include "commands.h"
#include "shared/output.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

/// What a built-in scene shows; one whose other files are not here is named all the same.
std::string titleOf(const std::string& name) {
  try {
    return findScenario(name).title;
  } catch (const InvalidParameter&) {
    return fmt::format("needs a file beside it: run scenarios/{}.toml", name);
  }
}

void listScenes(bool as_json) {
  Json rows = Json::array();
  std::string text = "Scenes with a name: haptolith run NAME\n\n";
  for (const std::string& name : sceneNames()) {
    const std::string title = titleOf(name);
    rows.push_back({{"name", name}, {"title", title}});
    text += fmt::format("  {:<14} {}\n", name, title);
  }
  as_json ? printJson({{"scenes", rows}}) : printText(text);
}

}  // namespace

void addScenesCommand(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("scenes", "The scenes with a name, for run and snapshot");
  command->add_flag("--json", *json, "Print one JSON object instead of a table");
  command->footer("Examples:\n  haptolith scenes\n  haptolith run sandbox");
  command->callback([json] { listScenes(*json); });
}

}  // namespace haptolith

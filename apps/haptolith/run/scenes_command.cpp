#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/scenario/built_in_scenes.h"

#include "commands.h"
#include "shared/output.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

/// The value of `title = "..."`.
std::string_view titleOf(std::string_view scene) {
  constexpr std::string_view kBegin = "\ntitle = \"";
  const std::size_t begin = scene.find(kBegin) + kBegin.size();
  return scene.substr(begin, scene.find('"', begin) - begin);
}

/// The comment that the file begins with: what the scene is for.
std::vector<std::string_view> purposeOf(std::string_view scene) {
  std::vector<std::string_view> lines;
  while (scene.starts_with("# ")) {
    const std::size_t end = scene.find('\n');
    lines.push_back(scene.substr(2, end - 2));
    scene.remove_prefix(end + 1);
  }
  return lines;
}

void listScenes(bool as_json) {
  Json rows = Json::array();
  std::string text = "Scenes with a name: haptolith run NAME\n";
  for (const BuiltInScene& scene : builtInScenes()) {
    const std::vector<std::string_view> purpose = purposeOf(scene.text);
    rows.push_back({{"name", scene.name},
                    {"title", titleOf(scene.text)},
                    {"purpose", fmt::format("{}", fmt::join(purpose, " "))}});
    text += fmt::format("\n  {:<14} {}\n", scene.name, titleOf(scene.text));
    for (const std::string_view line : purpose) {
      text += fmt::format("  {:<14}   {}\n", "", line);
    }
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

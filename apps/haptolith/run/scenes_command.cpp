#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "haptolith/bed/start/ready_tile.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/process/in_parallel.h"
#include "haptolith/machine/machine_fit.h"
#include "haptolith/scene_file/built_in_scenes.h"
#include "haptolith/scene_file/scene_file.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/output.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

/// Returns the value of `title = "..."`.
std::string_view titleOf(std::string_view scene) {
  constexpr std::string_view kBegin = "\ntitle = \"";
  const std::size_t begin = scene.find(kBegin) + kBegin.size();
  return scene.substr(begin, scene.find('"', begin) - begin);
}

/// Returns the comment at the begin of the file, the purpose of the scene.
std::vector<std::string_view> purposeOf(std::string_view scene) {
  std::vector<std::string_view> lines;
  while (scene.starts_with("# ")) {
    const std::size_t end = scene.find('\n');
    lines.push_back(scene.substr(2, end - 2));
    scene.remove_prefix(end + 1);
  }
  return lines;
}

/// Settles the soil of `auto` for each of its radii, for scenes/tiles (./dev tiles); existing files stay.
void makeTiles(const std::filesystem::path& folder) {
  const BedParameters any = findSceneFile(kAutoScene).bed;
  const auto threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  inParallel(kGrainRadii_m.size(), threads, [&](std::size_t i) {
    BedParameters bed = any;
    bed.soil = rescaled(any.soil, kGrainRadii_m[i]);
    const std::filesystem::path file = folder / readyTileName(bed);
    if (std::filesystem::exists(file)) {
      return;
    }
    AtomicFile out(file);
    out.write(readyTileBytes(settledTile(bed, [](double, double) { return !stopAsked(); }), bed));
    out.commit();
    printNotice(fmt::format("{}\n", file.string()));
  });
}

void listScenes(bool as_json) {
  Json rows = Json::array();
  std::string text = "Built-in scenes: haptolith run NAME\n";
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
  auto tiles = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("scenes", "List the built-in scenes");
  addJson(*command, *json);
  command->add_option("--make-tiles", *tiles, "Settle the soil that ships with the program, into this folder")
      ->group("");  // for ./dev tiles
  command->footer("Examples:\n  haptolith scenes\n  haptolith run sandbox");
  command->callback([json, tiles] {
    if (!tiles->empty()) {
      const StopOnSignal stop_on_signal;
      makeTiles(*tiles);
    } else {
      listScenes(*json);
    }
  });
}

}  // namespace haptolith

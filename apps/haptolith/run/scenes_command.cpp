#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "haptolith/bed/ready_tile.h"
#include "haptolith/core/atomic_file.h"
#include "haptolith/core/in_parallel.h"
#include "haptolith/machine/machine_fit.h"
#include "haptolith/scenario/scenario.h"

#include "commands.h"
#include "shared/output.h"
#include "shared/stop_on_signal.h"

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

/// Lets the soil of `auto` settle in each of its radii, for scenarios/tiles (./dev tiles); files that are there stay.
void makeTiles(const std::filesystem::path& folder) {
  const BedParameters any = findScenario(kAutoScene).bed;
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
  auto tiles = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("scenes", "The scenes with a name, for run and snapshot");
  command->add_flag("--json", *json, "Print one JSON object instead of a table");
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

#include <CLI/App.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/error.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/lab/archive/report_folder.h"
#include "haptolith/trust/band_trial.h"

#include "commands.h"
#include "lab/lab_options.h"
#include "shared/common_options.h"
#include "shared/kept_work.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/progress.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr Range kScenes{1, 10'000};
constexpr Range kFirstScene{0, 1e6};

struct BandOptions {
  int scenes = 50;
  std::uint64_t first = 450;
  int threads = 0;
  std::string folder;
  bool resume = false, json = false;
  Overwrite overwrite;
};

Json windowsJson(const std::vector<BandWindow>& windows) {
  Json json{{"windows", Json::array()}};
  for (const BandWindow& window : windows) {
    json["windows"].push_back({{"force_n", window.mean.force_n},
                               {"contacts", window.mean.contacts},
                               {"particle_n", window.particle_n},
                               {"low_n", window.band.low_n},
                               {"high_n", window.band.high_n},
                               {"reference_n", window.reference_n}});
  }
  return json;
}

/// The saved windows, with the band as it is now.
std::vector<BandWindow> windowsFrom(const Json& json, const SceneFile& scene) {
  std::vector<BandWindow> windows;
  const double gravity_m_s2 = scene.bed.gravity_m_s2.norm();
  for (const Json& window : json.at("windows")) {
    const auto at = [&](const char* key) { return window.at(key).get<double>(); };
    const MeanForce mean{at("force_n"), at("contacts")};
    windows.push_back({.mean = mean,
                       .reference_n = at("reference_n"),
                       .particle_n = at("particle_n"),
                       .band = forceRange(mean, scene.bed.soil, gravity_m_s2).value_or(ForceRange{})});
  }
  return windows;
}

struct Held {
  std::size_t windows = 0, held = 0;
  std::vector<double> half_widths;  ///< over the force

  void add(const std::vector<BandWindow>& more) {
    windows += more.size();
    held += static_cast<std::size_t>(std::ranges::count_if(more, &BandWindow::holds));
    for (const BandWindow& window : more) {
      if (window.mean.force_n > 0) {
        half_widths.push_back((window.band.high_n - window.band.low_n) / 2 / window.mean.force_n);
      }
    }
  }
  [[nodiscard]] double share() const {
    return windows > 0 ? static_cast<double>(held) / static_cast<double>(windows) : 0;
  }
  [[nodiscard]] double medianHalfWidth() {
    if (half_widths.empty()) {
      return 0;
    }
    const auto middle = half_widths.begin() + static_cast<std::ptrdiff_t>(half_widths.size() / 2);
    std::ranges::nth_element(half_widths, middle);
    return *middle;
  }
};

void runBand(const BandOptions& options) {
  const StopOnSignal stop_on_signal;
  const int threads = threadsFor(options.threads);
  const ReportFolder folder(options.folder, {{"force_band", "haptolith " HAPTOLITH_VERSION}, {"simd", simdTarget()}},
                            options.resume              ? ReportThere::kResume
                            : options.overwrite.allowed ? ReportThere::kReplace
                                                        : ReportThere::kRefuse);
  const auto count = static_cast<std::size_t>(options.scenes);
  std::vector<SceneFile> scenes;
  std::vector<std::vector<BandWindow>> windows(count);
  std::vector<std::size_t> missing;
  const auto name = [&](std::size_t i) { return fmt::format("scene-{}", options.first + i); };
  for (std::size_t i = 0; i < count; ++i) {
    scenes.push_back(bandScene(options.first + i));
    if (const std::optional<Json> saved = folder.result(name(i))) {
      try {
        windows[i] = windowsFrom(*saved, scenes[i]);
      } catch (const Json::exception& error) {
        throw Failure(
            fmt::format("{} is not a result of lab force-band ({}): remove it, and --resume repeats the scene",
                        folder.resultFile(name(i)).string(), error.what()));
      }
    } else {
      missing.push_back(i);
    }
  }
  constexpr double kUsual_s = 60;
  StatusLine status;
  KeptWork work(std::vector<double>(count, kUsual_s), threads, status);
  work.run(missing, folder.path(), [&](std::size_t i) {
    const std::string title = fmt::format("{}: {}", name(i), bandSceneName(scenes[i]));
    windows[i] = bandTrial(scenes[i], work.threadsEach(), work.progressOf(i, title));
    folder.save(name(i), windowsJson(windows[i]));
    work.finish(i, [&] { return fmt::format("{}: {}", title, pluralise(windows[i].size(), "window")); });
  });
  status.clear();

  Held all;
  std::map<std::string, Held> kinds;
  for (std::size_t i = 0; i < count; ++i) {
    all.add(windows[i]);
    kinds[scenes[i].soil_name].add(windows[i]);
    kinds[bandSceneName(scenes[i]).substr(scenes[i].soil_name.size() + 2)].add(windows[i]);
  }
  if (options.json) {
    Json json{{"scenes", count},
              {"windows", all.windows},
              {"held", all.share()},
              {"median_half_width", all.medianHalfWidth()}};
    for (auto& [kind, held] : kinds) {
      json["kinds"][kind] = {{"windows", held.windows}, {"held", held.share()}};
    }
    printJson(json);
    return;
  }
  std::string text = fmt::format(
      "{} of {} windows in {} are inside the 90 % band ({:.0f} %); half of it is {:.0f} % of the force (median)\n",
      all.held, all.windows, pluralise(count, "scene"), 100 * all.share(), 100 * all.medianHalfWidth());
  for (const auto& [kind, held] : kinds) {
    text += fmt::format("  {:<22} {:>4} windows, {:.0f} %\n", kind, held.windows, 100 * held.share());
  }
  printText(text);
}

}  // namespace

void addBand(CLI::App& lab) {
  auto options = std::make_shared<BandOptions>();
  CLI::App* command = lab.add_subcommand("force-band", "Test the band of the force on random beds and movements");
  command->add_option("--scenes", options->scenes, "Number of random scenes")
      ->check(wholeNumberIn(kScenes))
      ->capture_default_str();
  command->add_option("--first", options->first, "Number of the first; the band was fitted to scenes 1 to 349")
      ->check(wholeNumberIn(kFirstScene))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads [one per processor]");
  CLI::Option* folder =
      command->add_option("--out", options->folder, "Folder for the result of each scene")->required();
  CLI::Option* resume = command->add_flag("--resume", options->resume, "Continue in that folder")->needs(folder);
  options->overwrite.addTo(*command);
  command->get_option("--overwrite")->excludes(resume);
  addJson(*command, options->json);
  command->footer("Example:\n  haptolith lab force-band --out band");
  command->callback([options] { runBand(*options); });
}

}  // namespace haptolith

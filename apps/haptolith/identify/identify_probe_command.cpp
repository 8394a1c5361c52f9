#include <CLI/App.hpp>
#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/scene_file/scene_file.h"

#include "identify/identify_commands.h"
#include "identify/measured_options.h"
#include "identify/training_options.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/saved.h"
#include "shared/scene_options.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

constexpr const char* kIdentifyProbeExamples = R"(Examples:
  haptolith identify probe --out probe.csv
  haptolith identify probe --scene probe-field --out probe.csv
  haptolith run probe-field --poses probe.csv --trace measured.csv)";

struct ProbeOptions {
  std::string out_file;
  std::string scene;
  std::vector<double> origin_mm{0, 0, 0};
  Overwrite overwrite;
};

/// Returns the centre of the surface of a scene's soil.
Vec3 originIn(const std::string& scene) {
  const StopOnSignal stop;
  StatusLine status;
  const Bed bed(findSceneFile(scene).bed, settlingIn(status));
  return {0, 0, meanSurfaceHeight(bed)};
}

void writeProbe(const ProbeOptions& options) {
  const Vec3 origin_m = options.scene.empty()
                            ? Vec3(1e-3 * Vec3(options.origin_mm[0], options.origin_mm[1], options.origin_mm[2]))
                            : originIn(options.scene);
  writePoses(options.overwrite(options.out_file), digFor({}).movement, origin_m);
  printNotice(savedText());
  if (!options.scene.empty()) {
    printNotice(fmt::format("the soil's surface is at --origin-mm 0,0,{:.1f}\n", 1e3 * origin_m.z()));
  }
}

}  // namespace

void addIdentifyProbe(CLI::App& identify) {
  auto options = std::make_shared<ProbeOptions>();
  CLI::App* command = identify.add_subcommand("probe", "Write a shovel trajectory whose forces identify the soil");
  command->footer(kIdentifyProbeExamples);
  command->add_option("--out", options->out_file, "Write the trajectory, one pose per millisecond")
      ->option_text("FILE.csv")
      ->required();
  addOrigin(*command, options->origin_mm);
  command->add_option("--scene", options->scene, "Start at the settled surface of the bed of this scene")
      ->option_text("SCENE")
      ->excludes("--origin-mm");
  options->overwrite.addTo(*command);
  command->callback([options] { writeProbe(*options); });
}

}  // namespace haptolith

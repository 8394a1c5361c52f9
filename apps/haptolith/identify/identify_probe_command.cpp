#include <CLI/App.hpp>
#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "haptolith/bed/surface_height.h"
#include "haptolith/core/atomic_file.h"
#include "haptolith/scenario/scenario.h"

#include "identify/identify_commands.h"
#include "identify/training_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/saved.h"
#include "shared/scene_options.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

constexpr const char* kExamples = R"(Examples:
  haptolith identify probe --out probe.csv
  haptolith identify probe --scene field --out probe.csv && haptolith run field --poses probe.csv --trace measured.csv)";

struct ProbeOptions {
  std::string out_file;
  std::string scene;
  std::vector<double> origin_mm{0, 0, 0};
  Overwrite overwrite;
};

/// The middle of the surface of a scene's soil.
Vec3 originIn(const std::string& scene) {
  const StopOnSignal stop;
  StatusLine status;
  const Bed bed(findScenario(scene).bed, settlingIn(status));
  return {0, 0, meanSurfaceHeight(bed)};
}

void writeProbe(const ProbeOptions& options) {
  constexpr double kTick_s = 1e-3;
  const ToolMovement probe = digFor({}).movement;
  const Vec3 origin_m = options.scene.empty()
                            ? Vec3(1e-3 * Vec3(options.origin_mm[0], options.origin_mm[1], options.origin_mm[2]))
                            : originIn(options.scene);
  AtomicFile file(options.overwrite(options.out_file));
  file.write("t_s,x_m,y_m,z_m,qw,qx,qy,qz\n");
  const auto ticks = static_cast<int>(probe.duration() / kTick_s);
  for (int tick = 0; tick <= ticks; ++tick) {
    const Pose pose = probe.at(tick * kTick_s);
    const Vec3 p = pose.position_m + origin_m;
    const Quat& q = pose.orientation;
    file.write(fmt::format("{:.3f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n", tick * kTick_s, p.x(), p.y(),
                           p.z(), q.w(), q.x(), q.y(), q.z()));
  }
  file.commit();
  printNotice(savedText());
  if (!options.scene.empty()) {
    printNotice(fmt::format("the soil's surface is at --origin-mm 0,0,{:.1f}\n", 1e3 * origin_m.z()));
  }
}

}  // namespace

void addIdentifyProbe(CLI::App& identify) {
  auto options = std::make_shared<ProbeOptions>();
  CLI::App* command = identify.add_subcommand(
      "probe", "Write where a shovel goes, every millisecond, so that its forces tell about the soil");
  command->footer(kExamples);
  command->add_option("--out", options->out_file, "Where to write it")->option_text("FILE.csv")->required();
  command->add_option("--origin-mm", options->origin_mm, "Where the middle of the soil's surface is in its frame, z up")
      ->option_text("X,Y,Z [0,0,0]")
      ->delimiter(',')
      ->expected(3)
      ->check(numberIn({-1e5, 1e5}));
  command->add_option("--scene", options->scene, "The same for the bed of a scene, which then settles")
      ->option_text("SCENE")
      ->excludes("--origin-mm");
  options->overwrite.addTo(*command);
  command->callback([options] { writeProbe(*options); });
}

}  // namespace haptolith

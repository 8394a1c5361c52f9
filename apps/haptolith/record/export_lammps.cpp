#include "record/export_lammps.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>

#include "haptolith/bed/critical_step.h"
#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_folder.h"
#include "haptolith/lammps/lammps_export.h"
#include "haptolith/recording/replay.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/tool/tool_contact.h"

#include "shared/output.h"
#include "shared/saved.h"
#include "shared/scene_options.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kPicturesAtOnce = 4096;  // number of ticks read at a time

fs::path folderFor(const LammpsExportOptions& options) {
  if (!options.out.empty()) {
    return options.out;
  }
  const fs::path file = options.file;
  return (file.has_extension() ? fs::path(file).replace_extension() : file).filename().string() + "-lammps";
}

double stepOf(const SceneFile& scene, bool has_tool) {
  const double tool = has_tool ? stiffnessInStep(scene.tool, scene.bed.soil.friction) : 0;
  return scene.bed.tick_s / substepsFor(scene.bed, tool);
}

void write(const LammpsExportOptions& options, const SceneFile& scene, const Bed& bed, LammpsRun run) {
  run.title = scene.title;
  run.program = "haptolith " HAPTOLITH_VERSION;
  run.law = options.pair_style;
  const LammpsFiles files = lammpsFiles(bed, run);
  const AtomicFolder folder(folderFor(options));
  folder.write("bed.data", files.data);
  if (!files.table.empty()) {
    folder.write("rest.table", files.table);
  }
  folder.write("in.haptolith", files.input());
  folder.write("scene.toml", sceneFileText(scene));
  folder.commit();
  printText(savedText(folder.path(), files.tool_spheres > 0 ? fmt::format("{} grains and a tool of {} spheres",
                                                                          bed.particles(), files.tool_spheres)
                                                            : fmt::format("{} grains", bed.particles())));
  if (!files.law.exact) {
    spdlog::warn(
        "LAMMPS has no style for the contact law of this soil: in.haptolith uses the nearest style and lists the "
        "differences; --pair-style haptolith writes the exact law, for a LAMMPS built with extras/lammps; without "
        "cohesion, and with soil.gamma_nm = {:.4g}, contacts are springs, which LAMMPS supports",
        (1 - 3e-4) * linearGamma(scene.bed.soil));  // below the limit by k also after rounding
  }
  printText(
      fmt::format("  cd {} && lmp -in in.haptolith          ({})\n"
                  "  haptolith import {}/soil.lammpstrj --out dug.toml\n",
                  folder.path().string(),
                  options.pair_style == LammpsLaw::kHaptolith ? "built with haptolith's law: extras/lammps"
                                                              : "Debian's package lammps",
                  folder.path().string()));
}

void exportScene(const LammpsExportOptions& options) {
  if (options.from_s != 0) {
    throw InvalidParameter("from-s", fmt::format("{:g}", options.from_s), "left out: a scene has no recorded times");
  }
  const SceneFile scene = findSceneFile(options.file, options.overrides);
  validate(scene);
  StatusLine status;
  const Bed bed(scene.bed, settlingIn(status));
  status.clear();
  write(options, scene, bed, {.dt_s = stepOf(scene, false), .duration_s = options.duration_s});
}

/// Returns the tool's path from a time. @throws Failure if the scene was changed after it.
std::vector<TimedPose> pathOf(const RecordingReader& recording, const SceneFile& scene, double from_s) {
  if (recording.tools().size() > 1) {
    throw Failure(fmt::format("cannot export to LAMMPS: the recording has {} tools, and LAMMPS is given one",
                              recording.tools().size()));
  }
  const Joint& joint = scene.tool.joint;
  std::vector<TimedPose> path;
  for (std::uint64_t first = 0; first < recording.ticks(); first += kPicturesAtOnce) {
    for (const TickRecord& tick : recording.readTicks(first, kPicturesAtOnce)) {
      if (tick.time_s < from_s) {
        continue;
      }
      if ((tick.flags & (kTickSceneChanged | kTickSoilAdjusted)) != 0) {
        throw Failure(
            fmt::format("a client changed the scene {:.3f} s after the start of the recording: later ticks have other "
                        "soil or another tool",
                        tick.time_s));
      }
      path.push_back(
          {tick.time_s, joint.any() ? turned(tick.scene_T_tool, joint, tick.joint.angle_rad) : tick.scene_T_tool});
    }
  }
  if (path.size() < 2) {
    throw InvalidParameter("from-s", fmt::format("{:g}", from_s), "before the last two ticks of the recording");
  }
  return path;
}

void exportRecorded(const LammpsExportOptions& options) {
  if (!options.overrides.empty()) {
    throw InvalidParameter("set", options.overrides.front(), "left out: a recording contains its scene");
  }
  const RecordingReader recording(options.file);
  StatusLine status;
  Replay replay(recording, {}, settlingIn(status));
  const std::vector<TimedPose> path = pathOf(recording, replay.sceneFile(), options.from_s);
  if (options.from_s > 0) {
    bool is_there = false;
    const ReplayResult result = replay.run([&](const TickRecord& was, const TickRecord&) {
      status.tell([&] { return fmt::format("replaying {:.1f} s of {:.1f} s", was.time_s, options.from_s); });
      is_there = was.time_s >= options.from_s;
      return !stopAsked() && !is_there;
    });
    throwIfStopped();
    if (result.difference || !is_there) {
      throw Failure(fmt::format("cannot replay the bed at {:g} s: {}", options.from_s,
                                result.difference ? "the replay differs from the recording"
                                : result.gap      ? "ticks are missing before it"
                                                  : result.ended_early));
    }
  }
  status.clear();
  const SceneFile& scene = replay.sceneFile();
  write(options, scene, replay.loop().shownScene().scene.bed(),
        {.dt_s = stepOf(scene, true), .tool = &scene.tool, .path = path});
}

}  // namespace

void exportLammps(const LammpsExportOptions& options) {
  if (fs::path(options.file).extension() == ".h5") {
    exportRecorded(options);
  } else {
    exportScene(options);
  }
}

}  // namespace haptolith

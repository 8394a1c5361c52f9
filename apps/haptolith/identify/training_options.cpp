#include "identify/training_options.h"

#include <CLI/App.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>

#include "haptolith/bed/start/tile_cache.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/device/hand/pose_file.h"
#include "haptolith/identify/training/training_file.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/scene_words.h"

#include "shared/common_options.h"
#include "shared/kept_work.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

/// Returns a file's movement from its first pose, linear between poses that are at least 20 ms apart.
ToolMovement movementOf(const PoseFile& file) {
  constexpr double kBetween_s = 0.02;
  std::vector<TimedPose> poses;
  for (int i = 0; i * kBetween_s < file.duration(); ++i) {
    poses.push_back({i * kBetween_s, file.at(i * kBetween_s)});
  }
  poses.push_back({file.duration(), file.at(file.duration())});
  return ToolMovement(std::move(poses));
}

/// Returns the results that the command saved earlier, to resume. Not marked as an input, because inputs must not be
/// overwritten.
Training keptBefore(const std::filesystem::path& path) {
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{64} << 20;
  if (!std::filesystem::is_regular_file(path) || std::filesystem::file_size(path) > kMostBytes) {
    throw InvalidParameter("--resume", path.string(), "a file of this command, of at most 64 MiB");
  }
  std::ifstream file(path);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  return parseTraining(text, path.string());
}

Training begun(const SoilsOptions& options, const Dig& dig) {
  Training training{dig.movement, textOf(dig.tool), dig.field.gravity_m_s2, {}, {}};
  if (options.resume && std::filesystem::exists(options.out_file)) {
    Training before = keptBefore(options.out_file);
    if (before.tool != training.tool || before.gravity_m_s2 != training.gravity_m_s2 ||
        !isSameMovement(before.movement, training.movement)) {
      throw InvalidParameter("--resume", options.out_file, "a training of the same movement, tool and gravity");
    }
    training.runs = std::move(before.runs);
    training.temper = before.temper;
  } else {
    requireFree(options.overwrite(options.out_file));
  }
  return training;
}

}  // namespace

void MovementOptions::addTo(CLI::App& command) {
  command
      .add_option("--poses", poses_file,
                  "Movement of the tool: t_s,x_m,y_m,z_m,qw,qx,qy,qz, origin at the centre of the soil's surface")
      ->option_text("FILE.csv [the probe]");
  command.add_option("--scene", scene_file, "Scene with the tool, gravity and box")
      ->option_text("SCENE [a shovel on the Moon]");
  command.add_option("--set", overrides, kSetHelp)->option_text("TABLE.KEY=VALUE");
}

Dig digFor(const MovementOptions& options) {
  ToolParameters tool;
  DiggingField field;
  if (!options.scene_file.empty() || !options.overrides.empty()) {
    const SceneFile scene =
        findSceneFile(options.scene_file.empty() ? "probe-field" : options.scene_file, options.overrides);
    tool = scene.tool;
    field.width_m = scene.bed.width_m;
    field.length_m = scene.bed.length_m;
    field.depth_m = scene.bed.depth_m;
    field.gravity_m_s2 = scene.bed.gravity_m_s2.norm();
  }
  return {options.poses_file.empty() ? probeMovement(tool) : movementOf(PoseFile::read(options.poses_file)), tool,
          field};
}

void SoilsOptions::addTo(CLI::App& command, int usually) {
  soils = usually;
  movement.addTo(command);
  command.add_option("--soils", soils, "Number of soils")
      ->option_text(fmt::format("N [{}]", usually))
      ->check(wholeNumberIn({1, 10000}));
  command.add_option("--threads", threads, "Number of soils simulated at the same time")
      ->option_text("N [one per core]")
      ->check(wholeNumberIn({1, 256}));
  command.add_flag("--resume", resume, "Continue an interrupted command, or add soils");
  overwrite.addTo(command);
}

void keep(const SoilsOptions& options, const Training& training) {
  AtomicFile file(OutputFile{options.out_file, IfThere::kReplace});  // begun by this command, or resumed
  file.write(trainingText(training));
  file.commit();
}

Training dugSoils(const SoilsOptions& options, std::uint64_t (*number_of)(std::uint64_t place)) {
  const Dig dig = digFor(options.movement);
  Training training = begun(options, dig);
  const StopOnSignal stop;
  StatusLine status;
  useTileCache({});  // no cache, because these soils are used only once
  const auto count = static_cast<std::size_t>(options.soils);
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::ranges::none_of(training.runs, [&](const TrainingRun& run) { return run.number == number_of(i + 1); })) {
      missing.push_back(i);
    }
  }
  const int threads =
      options.threads > 0 ? options.threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  KeptWork work(std::vector<double>(count, 1), threads, status);
  work.run(missing, options.out_file, [&](std::size_t i) {
    const std::string title = fmt::format("soil {}", i + 1);
    std::optional<TrainingRun> run;
    try {
      run = trainingRun(dig.movement, dig.tool, dig.field, number_of(i + 1), work.progressOf(i, title));
    } catch (const Failure& failure) {  // a few of these soils do not settle
      if (work.ends()) {
        throw;
      }
      work.finish(i, [&] { return fmt::format("{} is left out: {}", title, failure.what()); });
      return;
    }
    work.finish(i, [&] {
      training.runs.push_back(std::move(*run));
      std::ranges::sort(training.runs, {}, &TrainingRun::number);
      training.temper.reset();
      keep(options, training);
      return std::string(title);
    });
  });
  return training;
}

std::string textOf(const ToolParameters& tool) {
  const Vec3 mm = 1e3 * tool.size_m;
  const std::string shape(wordFor(kToolShapeWords, tool.shape));
  return tool.shape == ToolShape::kBox ? fmt::format("{}, {:g} mm by {:g} mm by {:g} mm", shape, mm.x(), mm.y(), mm.z())
                                       : shape;
}

}  // namespace haptolith

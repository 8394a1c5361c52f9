#include <CLI/App.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstddef>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/lammps/lammps_dump.h"
#include "haptolith/lammps/lammps_export.h"
#include "haptolith/scene_file/scene_file.h"

#include "commands.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/saved.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr const char* kImportExamples = R"(Examples:
  haptolith export probe-field --format lammps                        write a bed for LAMMPS
  cd probe-field-lammps && mpirun -np 4 lmp -in in.haptolith          run it: writes soil.lammpstrj
  haptolith import probe-field-lammps/soil.lammpstrj --out dug.toml   make a scene of the last frame
  haptolith run dug.toml                                              run it)";

struct ImportOptions {
  std::string file, scene, out;
  std::optional<std::size_t> frame;
  Overwrite overwrite;
};

/// Returns the scene of the dump's bed; default: the one in the dump's folder.
SceneFile sceneOf(const ImportOptions& options) {
  if (!options.scene.empty()) {
    return findSceneFile(options.scene);
  }
  const fs::path beside = fs::path(options.file).parent_path() / "scene.toml";
  std::error_code ignored;
  if (!fs::exists(beside, ignored)) {
    throw InvalidParameter(
        "scene", "left out",
        fmt::format("a scene with this soil and box: there is no {}, which `haptolith export --format lammps` writes",
                    beside.string()));
  }
  return findSceneFile(beside.string());
}

/// Returns a bed as a table: the soil first, then held particles. Others, such as a tool, are left out.
std::string tableOf(const LammpsPicture& picture) {
  std::string text = "x_m,y_m,z_m,radius_m,held\n";
  for (const int type : {LammpsRun::kSoil, LammpsRun::kHeld}) {
    for (const DumpedGrain& grain : picture.grains) {
      if (grain.type == type) {
        fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g},{:.9g},{:.9g},{}\n", grain.centre_m.x(),
                       grain.centre_m.y(), grain.centre_m.z(), grain.radius_m, type == LammpsRun::kHeld ? 1 : 0);
      }
    }
  }
  return text;
}

void importDump(const ImportOptions& options) {
  const StopOnSignal stop_on_signal;
  fs::path out = options.out;
  if (out.extension() != ".toml") {
    throw InvalidParameter("out", options.out, "a file name ending in .toml");
  }
  const fs::path table = fs::path(out).replace_extension(".csv");
  AtomicFile scene_file(options.overwrite(out.string())), table_file(options.overwrite(table.string()));
  SceneFile scene = sceneOf(options);
  StatusLine status;
  const LammpsPicture picture = readLammpsDump(options.file, options.frame, [&](std::size_t passed) {
    status.tell([&] { return pluralise(passed, "frame") + " read"; });
    return !stopAsked();
  });
  status.clear();
  std::size_t taken = 0;
  for (const DumpedGrain& grain : picture.grains) {
    taken += grain.type == LammpsRun::kSoil || grain.type == LammpsRun::kHeld ? 1 : 0;
  }
  if (taken == 0) {
    throw InvalidParameter("dump", fmt::format("{} grains of other types", picture.grains.size()),
                           fmt::format("one with grains of type {} (soil) or {} (held)",
                                       static_cast<int>(LammpsRun::kSoil), static_cast<int>(LammpsRun::kHeld)));
  }
  table_file.write(tableOf(picture));
  table_file.commit();
  scene.title = fmt::format("Step {} of {}", picture.step, fs::path(options.file).filename().string());
  scene_file.write(sceneFileTextWithGrains(scene, table.filename().string()));
  scene_file.commit();
  printText(savedText(table,
                      fmt::format("{} of frame {}, step {}", pluralise(taken, "grain"), picture.number, picture.step)));
  printText(savedText(out, "a scene of them"));
  if (!options.frame && picture.number > 1) {
    printText(fmt::format("  the last of {} frames; --frame N selects another\n", picture.number));
  }
  if (taken < picture.grains.size()) {
    printText(fmt::format("  {} others, of types other than {} (soil) and {} (held), are left out: a tool\n",
                          picture.grains.size() - taken, static_cast<int>(LammpsRun::kSoil),
                          static_cast<int>(LammpsRun::kHeld)));
  }
}

}  // namespace

void addImportCommand(CLI::App& app) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* command = app.add_subcommand("import", "Make a scene from a LAMMPS dump");
  command->footer(kImportExamples);
  command->add_option("dump", options->file, "LAMMPS `dump custom` text file with id, x, y, z and radius")
      ->required()
      ->option_text("FILE");
  command->add_option("--scene", options->scene, "Scene with soil, box and tool [scene.toml next to the dump]")
      ->option_text("SCENE");
  command->add_option("--out", options->out, "New scene file; particles are written to a .csv next to it")
      ->required()
      ->option_text("FILE.toml");
  command->add_option("--frame", options->frame, "Number of the frame in the dump, from 1 [the last]")
      ->check(numberIn({1, 1e9}))
      ->option_text("N");
  options->overwrite.addTo(*command);
  command->callback([options] { importDump(*options); });
}

}  // namespace haptolith

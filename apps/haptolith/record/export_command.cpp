#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/files/atomic_folder.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/lammps/lammps_law.h"
#include "haptolith/recording/export_pictures.h"
#include "haptolith/recording/recorded_pictures.h"
#include "haptolith/recording/recording_reader.h"
#include "haptolith/viewer/film.h"

#include "commands.h"
#include "record/export_lammps.h"
#include "record/export_lammps_dump.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/saved.h"
#include "shared/scene_options.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr const char* kExportExamples = R"(Examples:
  haptolith export run.h5 --format csv             run.csv: one row per tick
  haptolith export run.h5 --format particles-csv   run-particles.csv: one row per particle and frame
  haptolith export run.h5 --format robot-csv       run-robot.csv: one row per report of a robot
  haptolith export run.h5 --format xdmf            run-xdmf/: particles, tool and box for ParaView
  haptolith export run.h5 --format vtk             run-vtk/: the same without HDF5
  haptolith export run.h5 --format film            run.film: animation for the browser demo
  haptolith export soil.lammpstrj --format vtk     soil-vtk/: frames of a LAMMPS dump
  haptolith export run.h5 --format lammps          run-lammps/: bed and tool motion for LAMMPS
  haptolith export probe-field --format lammps     probe-field-lammps/: a scene's bed, no tool

Particles have id, radius, velocity and contact force. A recording does not contain velocities:
the run is replayed to compute them, which takes as long as a run with --no-realtime.)";

constexpr std::uint64_t kBlock = 4096;  // number of rows read at a time

struct ExportOptions {
  std::string file, format, out, tool;
  bool no_replay = false;
  std::vector<std::string> overrides;
  double from_s = 0, duration_s = 1;
  LammpsLaw pair_style = LammpsLaw::kStandard;
  Overwrite overwrite;
};

/// Returns the default output name: run.csv or run-vtk for run.h5. Never the name of the recording.
fs::path outFor(const ExportOptions& options, std::string_view ending) {
  if (!options.out.empty()) {
    return options.out;
  }
  const fs::path file = options.file;
  return (file.extension() == ".h5" ? fs::path(file).replace_extension() : file).string() + std::string(ending);
}

/// The number of the tool that was asked for.
std::size_t toolOf(const RecordingReader& recording, const ExportOptions& options) {
  const std::vector<RecordedTool>& tools = recording.tools();
  const auto found = options.tool.empty() ? tools.begin() : std::ranges::find(tools, options.tool, &RecordedTool::name);
  if (found == tools.end()) {
    std::vector<std::string_view> names;
    std::ranges::transform(tools, std::back_inserter(names), &RecordedTool::name);
    throw InvalidParameter("tool", inQuotes(options.tool), fmt::format("one of {}", fmt::join(names, ", ")));
  }
  return static_cast<std::size_t>(found - tools.begin());
}

/// Writes one row per tick; numbers are read back bit-identically.
void exportCsv(const RecordingReader& recording, const ExportOptions& options) {
  const std::size_t tool = toolOf(recording, options);
  const bool has_joint = recording.tools()[tool].has_joint;
  const fs::path out = outFor(options, ".csv");
  AtomicFile file(options.overwrite(out.string()));
  StatusLine status;
  std::string text = csvHeader(has_joint ? tickColumnsWithJoint() : tickColumns());
  for (std::uint64_t first = 0; first < recording.ticks(); first += kBlock) {
    status.tell([&] { return fmt::format("tick {} of {}", first, recording.ticks()); });
    throwIfStopped();
    for (const TickRecord& tick : recording.readTicks(first, kBlock, tool)) {
      appendCsv(text, tick, has_joint);
    }
    file.write(text);
    text.clear();
  }
  file.write(text);
  file.commit();
  status.clear();
  printText(savedText(out, pluralise(recording.ticks(), "tick")));
}

std::string picturesText(const RecordedPictures& pictures) {
  const std::string count = fmt::format("{} of the particles", pluralise(pictures.count(), "frame"));
  return pictures.replayed() == pictures.count() ? count + " with velocities"
         : pictures.replayed() == 0              ? count + " without velocities"
                                    : fmt::format("{}, {} of them with velocities", count, pictures.replayed());
}

/// Writes one row per report of a robot; numbers as above.
void exportCsvOfRobot(const RecordingReader& recording, const ExportOptions& options) {
  if (recording.reports() == 0) {
    throw Failure(fmt::format("{} contains no reports of a robot: record them with haptolith teleop operator --record",
                              options.file));
  }
  const fs::path out = outFor(options, "-robot.csv");
  AtomicFile file(options.overwrite(out.string()));
  file.write(csvHeader(robotColumns()));
  for (std::uint64_t first = 0; first < recording.reports(); first += kBlock) {
    std::string text;
    for (const RobotRow& row : recording.readReports(first, kBlock)) {
      appendCsv(text, row);
    }
    file.write(text);
  }
  file.commit();
  printText(savedText(out, fmt::format("{} reports of a robot", recording.reports())));
}

void requirePictures(const RecordingReader& recording, const ExportOptions& options) {
  if (recording.frames() == 0) {
    throw Failure(
        fmt::format("{} contains no frames of the particles: export its ticks with --format csv", options.file));
  }
}

/// Exports the snapshots of a recording with `write`.
template <class Write>
void exportPictures(const RecordingReader& recording, const ExportOptions& options, const fs::path& out, Write write) {
  StatusLine status;
  const double end_s =
      static_cast<double>(recording.header().start_tick + recording.ticks()) * recording.header().tick_s;
  const auto reached = [&](double time_s) {
    status.tell([&] {
      return fmt::format("{} {:.1f} s of {:.1f} s", options.no_replay ? "reading" : "replaying", time_s, end_s);
    });
    return !stopAsked();
  };
  RecordedPictures pictures(recording,
                            {.replay = !options.no_replay, .settling = settlingIn(status), .reached = reached});
  write(pictures);
  status.clear();
  printText(savedText(out, picturesText(pictures)));
  if (!pictures.whyNotReplayed().empty()) {
    spdlog::warn("{} of {} frames have no velocities: {}", pictures.count() - pictures.replayed(), pictures.count(),
                 pictures.whyNotReplayed());
  }
}

void exportCsvOfParticles(const RecordingReader& recording, const ExportOptions& options) {
  requirePictures(recording, options);
  const fs::path out = outFor(options, "-particles.csv");
  AtomicFile file(options.overwrite(out.string()));
  exportPictures(recording, options, out, [&](RecordedPictures& pictures) {
    exportParticlesCsv(pictures, [&](std::string_view text) { file.write(text); });
    file.commit();
  });
}

void exportFilmOfPage(const RecordingReader& recording, const ExportOptions& options) {
  requirePictures(recording, options);
  const fs::path out = outFor(options, ".film");
  AtomicFile file(options.overwrite(out.string()));
  exportPictures(recording, options, out, [&](RecordedPictures& pictures) {
    exportFilm(pictures, HAPTOLITH_VERSION, [&](std::string_view bytes) { file.write(bytes); });
    file.commit();
  });
}

using ExportToFolder = void (*)(RecordedPictures&, const AtomicFolder&);

void exportFolder(const RecordingReader& recording, const ExportOptions& options, ExportToFolder make) {
  requirePictures(recording, options);
  const fs::path out = outFor(options, "-" + options.format);
  const AtomicFolder folder(out);
  exportPictures(recording, options, out, [&](RecordedPictures& pictures) {
    make(pictures, folder);
    folder.commit();
  });
}

void exportRecording(const ExportOptions& options) {
  const StopOnSignal stop_on_signal;  // before any output exists
  if (options.format == "vtk" && isLammpsDump(options.file)) {
    const fs::path out =
        options.out.empty() ? fs::path(options.file).replace_extension().string() + "-vtk" : options.out;
    return exportLammpsDump(options.file, out);
  }
  if (options.format == "lammps") {
    return exportLammps(
        {options.file, options.overrides, options.out, options.from_s, options.duration_s, options.pair_style});
  }
  const RecordingReader recording(options.file);
  if (options.format == "csv") {
    exportCsv(recording, options);
  } else if (options.format == "particles-csv") {
    exportCsvOfParticles(recording, options);
  } else if (options.format == "robot-csv") {
    exportCsvOfRobot(recording, options);
  } else if (options.format == "film") {
    exportFilmOfPage(recording, options);
  } else {
    exportFolder(recording, options, options.format == "xdmf" ? exportXdmf : exportVtk);
  }
  if (recording.missingTicks() > 0) {
    spdlog::warn("{} lacks {}, because the disk or the machine was too slow; the tick numbers show the gaps",
                 options.file, pluralise(recording.missingTicks(), "tick"));
  }
}

}  // namespace

void addExportCommand(CLI::App& app) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand(
      "export", "Convert a recording or a scene for other programs: CSV, XDMF, VTK, LAMMPS, browser");
  command->footer(kExportExamples);
  command->add_option("file", options->file, "Recording (.h5); lammps also accepts a scene, vtk also a LAMMPS dump")
      ->required()
      ->option_text("FILE");
  command
      ->add_option("--format", options->format,
                   "Format. csv: ticks; particles-csv: particles; robot-csv: reports of the robot that followed the "
                   "tool; xdmf, vtk: particles, tool and box for ParaView; film: animation for a browser; lammps: bed "
                   "and tool as an input script for LAMMPS")
      ->required()
      ->check(oneOf({"csv", "particles-csv", "robot-csv", "xdmf", "vtk", "film", "lammps"}))
      ->option_text("csv|particles-csv|robot-csv|xdmf|vtk|film|lammps");
  command
      ->add_option("--out", options->out,
                   "Output file; a new folder for xdmf, vtk and lammps [named after the recording]")
      ->option_text("PATH");
  command->add_option("--tool", options->tool, "For csv: the tool, where there are several [the first]")
      ->option_text("NAME");
  command->add_flag("--no-replay", options->no_replay, "Do not replay the run; export without velocities");
  command->add_option("--set", options->overrides, "For lammps: set a key of the scene; can be repeated")
      ->option_text("TABLE.KEY=VALUE");
  command->add_option("--from-s", options->from_s, "For lammps: start at this time of the recording")
      ->check(numberIn({0, 1e9}))
      ->option_text("SECONDS [0]");
  command->add_option("--duration-s", options->duration_s, "For lammps: duration of the run of a scene")
      ->check(numberIn({1e-3, 1e6}))
      ->option_text("SECONDS [1]");
  const std::map<std::string, LammpsLaw> styles{{"standard", LammpsLaw::kStandard},
                                                {"haptolith", LammpsLaw::kHaptolith}};
  command
      ->add_option("--pair-style", options->pair_style,
                   "For lammps: contact law. standard: nearest law of standard LAMMPS; haptolith: exact law, for a "
                   "LAMMPS built with extras/lammps [standard]")
      ->transform(wordOf(styles))
      ->option_text("standard|haptolith");
  options->overwrite.addTo(*command);
  command->callback([options] { exportRecording(*options); });
}

}  // namespace haptolith

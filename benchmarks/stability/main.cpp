// Stability of hand, device and soil: a sweep over grips, devices, delays and soils, each with and without the
// passivity controller. CSV on stdout, a summary on stderr.
//
//     build/release/benchmarks/haptolith_stability --figure docs/images/stability.svg > stability.csv
//
// and for devices with undeclared delay, resolution and noise, with light hands and the default settings:
//
//     build/release/benchmarks/haptolith_stability --unknown > unknown.csv

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/process/in_parallel.h"
#include "haptolith/figure/figure.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/presets.h"

#include "stability.h"

namespace haptolith {
namespace {

/// Maximum harmless energy transferred to a hand, J.
constexpr double kHarmless_j = 1e-3;
/// Maximum work of the force on a released handle at a device of unknown delay, J.
constexpr double kReleased_j = 5e-3;

constexpr HoldingHand kHands[]{kStiffHand, kLooseHand, kNoHand, kOpeningHand};

struct Soil {
  std::string preset, body;
  FrictionModel friction = FrictionModel::kIcra2021;
  BedParameters bed;
  LyingSoil lying;
};

struct Cell {
  const Soil* soil = nullptr;
  StabilityCase setting;
  StabilityResult result;
};

Soil soilOf(const std::string& preset, const std::string& body, FrictionModel friction) {
  BedParameters bed;
  bed.soil = findPreset(preset).soil;
  bed.gravity_m_s2 = {0, 0, -findBody(body).gravity_m_s2};
  if (friction == FrictionModel::kContact) {
    bed.soil.friction = friction;
    bed.soil.stiffness_n_m = 3000;  // as in the named soils
    bed.start = BedStart::kRain;
  }
  return {preset, body, friction, bed, {}};
}

std::vector<Soil> soils(int threads) {
  std::vector<Soil> all;
  for (const FrictionModel friction : {FrictionModel::kIcra2021, FrictionModel::kContact}) {
    for (const char* preset : {"P1", "P3", "P6"}) {
      for (const char* body : {"Moon", "Earth"}) {
        all.push_back(soilOf(preset, body, friction));
      }
    }
  }
  inParallel(all.size(), threads, [&all](std::size_t i) { all[i].lying = settled(all[i].bed); });
  return all;
}

std::vector<Cell> cellsOf(const std::vector<Soil>& soils) {
  std::vector<Cell> cells;
  for (const CouplingKind coupling : {CouplingKind::kDirect, CouplingKind::kVirtual}) {
    for (const Soil& soil : soils) {
      for (const HoldingHand& hand : kHands) {
        for (const double damping_n_s_m : {0.0, 1.0, 2.0}) {
          for (const int delay : {0, 2, 5}) {
            for (const bool passivity : {false, true}) {
              StabilityCase setting;
              setting.hand = hand;
              setting.damping_n_s_m = damping_n_s_m;
              setting.delay_ticks = delay;
              setting.coupling = coupling;
              setting.passivity = passivity;
              cells.push_back({&soil, setting, {}});
            }
          }
        }
      }
    }
  }
  return cells;
}

const char* text(CouplingKind coupling) {
  return coupling == CouplingKind::kVirtual ? "virtual" : "direct";
}

const char* text(FrictionModel friction) {
  return friction == FrictionModel::kContact ? "contact" : "icra2021";
}

void print(const std::vector<Cell>& cells) {
  fmt::print(
      "coupling,friction,preset,body,grip,damping_n_s_m,delay_ms,controller,"
      "injected_mj,returned_mj,vibration_mm,damped_share,end\n");
  for (const Cell& cell : cells) {
    const auto& [soil, setting, result] = cell;
    fmt::print("{},{},{},{},{},{:g},{},{},{:.4g},{:.4g},{:.4g},{:.4g},{}\n", text(setting.coupling),
               text(soil->friction), soil->preset, soil->body, setting.hand.name, setting.damping_n_s_m,
               setting.delay_ticks, setting.passivity ? "on" : "off", 1e3 * result.injected_j, 1e3 * result.returned_j,
               1e3 * result.vibration_m, result.damped_share, result.end == LoopEnd::kRunning ? "" : "ended early");
  }
}

/// Maximum and median of a set of cells.
struct Worst {
  std::size_t cells = 0, harmful = 0, ended = 0;
  double injected_j = 0, vibration_m = 0, usual_vibration_m = 0, damped_share = 0;
};

template <class Belongs>
Worst worstOf(const std::vector<Cell>& cells, const Belongs& belongs) {
  Worst worst;
  std::vector<double> vibrations_m;
  for (const Cell& cell : cells) {
    if (belongs(cell)) {
      ++worst.cells;
      worst.harmful += cell.result.injected_j > kHarmless_j ? 1 : 0;
      worst.ended += cell.result.end != LoopEnd::kRunning ? 1 : 0;
      worst.injected_j = std::max(worst.injected_j, cell.result.injected_j);
      worst.vibration_m = std::max(worst.vibration_m, cell.result.vibration_m);
      worst.damped_share = std::max(worst.damped_share, cell.result.damped_share);
      vibrations_m.push_back(cell.result.vibration_m);
    }
  }
  std::ranges::sort(vibrations_m);
  worst.usual_vibration_m = vibrations_m.empty() ? 0 : vibrations_m[vibrations_m.size() / 2];
  return worst;
}

void summarise(const std::vector<Cell>& cells) {
  fmt::print(stderr, "{:9}{:10}{:9}{:>6}{:>5}{:>7}{:>6}{:>7}{:>14}{:>15}{:>13}{:>9}\n", "coupling", "friction", "grip",
             "delay", "ctl", "cells", ">1mJ", "ended", "injected_mj", "vibration_mm", "median_mm", "damped");
  for (const CouplingKind coupling : {CouplingKind::kDirect, CouplingKind::kVirtual}) {
    for (const FrictionModel friction : {FrictionModel::kIcra2021, FrictionModel::kContact}) {
      for (const HoldingHand& hand : kHands) {
        for (const int delay : {0, 2, 5}) {
          for (const bool passivity : {false, true}) {
            const Worst worst = worstOf(cells, [&](const Cell& cell) {
              return cell.setting.coupling == coupling && cell.soil->friction == friction &&
                     cell.setting.hand.name == std::string_view(hand.name) && cell.setting.delay_ticks == delay &&
                     cell.setting.passivity == passivity;
            });
            if (worst.cells > 0) {
              fmt::print(stderr, "{:9}{:10}{:9}{:>6}{:>5}{:>7}{:>6}{:>7}{:>14.3g}{:>15.3g}{:>13.3g}{:>9.2g}\n",
                         text(coupling), text(friction), hand.name, delay, passivity ? "on" : "off", worst.cells,
                         worst.harmful, worst.ended, 1e3 * worst.injected_j, 1e3 * worst.vibration_m,
                         1e3 * worst.usual_vibration_m, worst.damped_share);
            }
          }
        }
      }
    }
  }
}

/// Draws a point for each cell: energy transferred to the hand and vibration of the handle, without and with
/// controller.
void draw(const std::string& path, const std::vector<Cell>& cells) {
  const double grounds[] = {1e-4, 1e-5};  // smaller values are drawn on the frame: mJ, mm
  Figure figure({path, IfThere::kReplace}, 1100, 520);
  for (const CouplingKind coupling : {CouplingKind::kDirect, CouplingKind::kVirtual}) {
    std::vector<std::vector<double>> rows;
    for (std::size_t i = 0; i + 1 < cells.size(); i += 2) {  // consecutive cells: controller off and on
      const Cell& off = cells[i];
      const Cell& on = cells[i + 1];
      if (off.setting.coupling == coupling) {
        rows.push_back(
            {std::max(grounds[0], 1e3 * off.result.injected_j), std::max(grounds[0], 1e3 * on.result.injected_j),
             std::max(grounds[1], 1e3 * off.result.vibration_m), std::max(grounds[1], 1e3 * on.result.vibration_m)});
      }
    }
    figure.data(text(coupling), rows);
  }
  figure.command(fmt::format(R"(
set multiplot layout 1,2
set logscale xy
set format '10^{{%T}}'
set key top left
set xlabel 'controller off'
set ylabel 'controller on'
set title 'most energy given to the hand, mJ (on the frame: less than 10^{{-4}})'
set xrange [{0}:*]
set yrange [{0}:*]
plot x with lines lc '#999999' title 'no difference', {2} with lines dt 2 lc '#cc0000' title '1 mJ', \
  $direct using 1:2 with points pt 7 ps 0.5 lc '#0072b2' title 'direct', $virtual using 1:2 with points pt 6 ps 0.7 lc '#e69f00' title 'virtual'
set title 'vibration above 6 Hz, hand at rest, mm'
set xrange [{1}:*]
set yrange [{1}:*]
plot x with lines lc '#999999' title 'no difference', \
  $direct using 3:4 with points pt 7 ps 0.5 lc '#0072b2' title 'direct', $virtual using 3:4 with points pt 6 ps 0.7 lc '#e69f00' title 'virtual'
unset multiplot)",
                             grounds[0], grounds[1], 1e3 * kHarmless_j));
  figure.save();
}

/// Limits of the network device at its default settings: NetworkDevice::limits().
constexpr int kAssumedDelay_ticks = 10;
constexpr double kAssumedResolution_m = 1e-4;

/// Returns the case of a handle of 0.1 kg at a device that declares neither delay nor resolution.
StabilityCase atUnknownDevice(const HoldingHand& hand, int delay_ticks, double step_m, double noise_m) {
  StabilityCase setting;
  setting.hand = hand;
  setting.handle_kg = 0.1;
  setting.delay_ticks = delay_ticks;
  setting.declared_ticks = kAssumedDelay_ticks;
  setting.step_m = step_m;
  setting.noise_m = noise_m;
  setting.resolution_m = kAssumedResolution_m;
  setting.coupling = CouplingKind::kVirtual;
  return setting;
}

struct UnknownCell {
  const SceneFile* scene_file = nullptr;
  const LyingSoil* lying = nullptr;
  StabilityCase setting;
  StabilityResult result, without;
};

/// Runs 3 soils, 5 hands, 5 delays, 3 resolutions and 2 noises, with a handle of 0.1 kg.
int unknownDevices(int threads) {
  const std::vector<SceneFile> scenes{
      loadSceneFileText("title = \"P3, Moon\"", "A"),
      loadSceneFileText("title = \"P6, Earth, contact\"\n[soil]\npreset = \"P6\"\nfriction_model = \"contact\"\n"
                        "stiffness_n_m = 3000\n[gravity]\nbody = \"Earth\"\n[bed]\nstart = \"rain\"",
                        "B"),
      loadSceneFileText("title = \"apollo-15-srp\"\n[soil]\nname = \"apollo-15-srp\"", "C")};
  std::vector<LyingSoil> lying(scenes.size());
  inParallel(scenes.size(), threads, [&](std::size_t i) { lying[i] = settled(scenes[i].bed); });
  std::vector<HoldingHand> hands(std::begin(kLightHands), std::end(kLightHands));
  hands.push_back(kNoHand);
  std::vector<UnknownCell> cells;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    for (const HoldingHand& hand : hands) {
      for (const int delay : {0, 1, 2, 5, 10}) {
        for (const double step_m : {0.0, 2e-5, 6e-5}) {
          for (const double noise_m : {0.0, 1e-4}) {
            cells.push_back({&scenes[i], &lying[i], atUnknownDevice(hand, delay, step_m, noise_m), {}, {}});
          }
        }
      }
    }
  }
  inParallel(cells.size(), threads, [&cells](std::size_t i) {
    UnknownCell& cell = cells[i];
    StabilityCase setting = cell.setting;
    cell.result = measureStability(cell.scene_file->bed, *cell.lying, setting, cell.scene_file->tool);
    setting.passivity = false;
    cell.without = measureStability(cell.scene_file->bed, *cell.lying, setting, cell.scene_file->tool);
  });
  fmt::print(
      "soil,hand,delay_ms,step_mm,noise_mm,injected_mj,vibration_mm,vibration_before_mm,held_n,held_without_n\n");
  double injected_j = 0, vibration_m = 0, left_exact = 1, left_steps = 1;
  for (const UnknownCell& cell : cells) {
    const StabilityCase& setting = cell.setting;
    const StabilityResult& result = cell.result;
    fmt::print("\"{}\",\"{}\",{},{:g},{:g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g}\n", cell.scene_file->title,
               setting.hand.name, setting.delay_ticks, 1e3 * setting.step_m, 1e3 * setting.noise_m,
               1e3 * result.injected_j, 1e3 * result.vibration_m, 1e3 * result.vibration_before_m, result.held_n,
               cell.without.held_n);
    injected_j = std::max(injected_j, result.injected_j);
    vibration_m = std::max(vibration_m, result.vibration_m);
    if (setting.hand.name == std::string_view(kLightHands[0].name) && setting.delay_ticks == 0 &&
        setting.noise_m == 0) {
      double& left = setting.step_m == 0 ? left_exact : left_steps;
      left = std::min(left, result.held_n / cell.without.held_n);
    }
  }
  fmt::print(
      stderr,
      "{} settings: at most {:.3g} mJ given to the hand and {:.3g} mm of vibration; a stiff hand without delay keeps "
      "{:.3g} of the force, in steps {:.3g}\n",
      cells.size(), 1e3 * injected_j, 1e3 * vibration_m, left_exact, left_steps);
  return 0;
}

/// Runs a handle of 0.1 kg at a device of unknown delay: released 15 mm deep in the soil or dropped from 1 mm or 20 mm,
/// with and without weight.
int releasedHandles(int threads) {
  const std::vector<SceneFile> scenes{
      loadSceneFileText("title = \"A: P3, Moon\"", "A"),
      loadSceneFileText("title = \"B: P6, Earth, contact\"\n[soil]\npreset = \"P6\"\nfriction_model = \"contact\"\n"
                        "stiffness_n_m = 3000\n[gravity]\nbody = \"Earth\"",
                        "B"),
      loadSceneFileText("title = \"C: apollo-15-srp\"\n[soil]\nname = \"apollo-15-srp\"", "C"),
      loadSceneFileText("title = \"lunar-0-15cm\"\n[soil]\nname = \"lunar-0-15cm\"", "lunar")};
  std::vector<LyingSoil> lying(scenes.size());
  inParallel(scenes.size(), threads, [&](std::size_t i) { lying[i] = settled(scenes[i].bed); });
  std::vector<UnknownCell> cells;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    for (const HoldingHand& hand : kReleasedHands) {
      for (const int delay : {0, 2, 5, 10}) {
        for (const double step_m : {0.0, 6e-5}) {
          cells.push_back({&scenes[i], &lying[i], atUnknownDevice(hand, delay, step_m, 0), {}, {}});
        }
      }
    }
  }
  inParallel(cells.size(), threads, [&cells](std::size_t i) {
    UnknownCell& cell = cells[i];
    cell.result = measureStability(cell.scene_file->bed, *cell.lying, cell.setting, cell.scene_file->tool);
  });
  fmt::print("soil,hand,weight_n,delay_ms,step_mm,injected_mj,released_n,after_release_mj,vibration_mm,softest\n");
  double most_j = 0;
  std::size_t above = 0;
  for (const auto& [scene_file, soil, setting, result, without] : cells) {
    fmt::print("\"{}\",\"{}\",{:g},{},{:g},{:.4g},{:.4g},{:.4g},{:.4g},{:.3g}\n", scene_file->title, setting.hand.name,
               setting.hand.weight_n, setting.delay_ticks, 1e3 * setting.step_m, 1e3 * result.injected_j,
               result.released_n, 1e3 * result.after_release_j, 1e3 * result.vibration_m, result.softest);
    most_j = std::max(most_j, result.after_release_j);
    above += result.after_release_j > kReleased_j ? 1U : 0U;
  }
  fmt::print(stderr, "{} settings: the force does at most {:.3g} mJ of work on the handle; {} above {:g} mJ\n",
             cells.size(), 1e3 * most_j, above, 1e3 * kReleased_j);
  return above > 0 ? 1 : 0;
}

int sweep(int argc, char** argv) {
  CLI::App app("A simulated hand at a simulated device in soil: what becomes of energy, cell by cell, as CSV.");
  std::string figure;
  int threads = 2;
  app.add_option("--figure", figure, "draw the cells into this .svg or .png file");
  app.add_option("--threads", threads, "cells at a time")->check(CLI::Range(1, 256))->capture_default_str();
  bool unknown = false;
  app.add_flag("--unknown", unknown, "devices that nobody has measured, instead of the sweep");
  bool released = false;
  app.add_flag("--released", released, "A released or dropped light handle at such devices");
  CLI11_PARSE(app, argc, argv);
  if (released) {
    return releasedHandles(threads);
  }
  if (unknown) {
    return unknownDevices(threads);
  }
  const std::vector<Soil> beds = soils(threads);
  std::vector<Cell> cells = cellsOf(beds);
  inParallel(cells.size(), threads, [&cells](std::size_t i) {
    cells[i].result = measureStability(cells[i].soil->bed, cells[i].soil->lying, cells[i].setting);
  });
  print(cells);
  summarise(cells);
  if (!figure.empty()) {
    draw(figure, cells);
  }
  return 0;
}

}  // namespace
}  // namespace haptolith

int main(int argc, char** argv) {
  try {
    return haptolith::sweep(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "haptolith_stability: {}\n", error.what());
    return 1;
  }
}

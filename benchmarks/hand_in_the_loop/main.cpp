// Independent test of the force on a hand: simulates a person at a haptic device, over UDP, against a haptolith that it
// starts. It uses no information about haptolith except docs/reference/udp.md. README.md in this folder explains usage
// and results.

#include <CLI/CLI.hpp>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "runs.h"
#include "self_test.h"
#include "session.h"

namespace hand_in_the_loop {
namespace {

namespace fs = std::filesystem;

struct Options {
  Settings settings;
  std::vector<std::string> soils, grips;
  std::vector<double> delays_ms, steps_mm, noises_mm;
  std::string csv, filter, keep, record;
  int jobs = 1, again = 3, repeat = 1, count = 200;
  std::uint32_t seed = 1;
  double seconds = 0;
  bool json = false;
};

/// Computes the seed of a run from its name (FNV-1a), independent of the other runs.
std::uint32_t seedOf(const std::string& name, std::uint32_t seed) {
  std::uint32_t hash = 2166136261U ^ seed;
  for (const char c : name) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  }
  return hash;
}

/// Returns the name of a run: soil, grip and disturbance, then all settings other than the defaults.
std::string nameOf(const Settings& s, const std::string& given, int repeat) {
  const Settings usual;
  std::string name = s.soil + '/' + s.grip + '/' + shortNumber(s.device.delay_ms) + "ms/" +
                     shortNumber(s.device.step_mm) + "mm/" + shortNumber(s.device.noise_mm) + "mm";
  const auto add = [&name](const char* what, double value, double usual_value) {
    if (value != usual_value) {
      name += std::string("/") + what + '=' + shortNumber(value);
    }
  };
  if (s.device.delay_at != usual.device.delay_at) {
    name += s.device.delay_at == DelayAt::kShow ? "/show" : "/measure";
  }
  add("mass", s.handle.mass_kg, usual.handle.mass_kg);
  add("damping", s.handle.damping_n_s_m, usual.handle.damping_n_s_m);
  add("weight", s.weight_n, usual.weight_n);
  add("handle-weight", s.handle_weight_n, usual.handle_weight_n);
  add("jitter", s.device.jitter_ms, usual.device.jitter_ms);
  add("drop", s.device.drop, usual.device.drop);
  add("force-step", s.device.force_step_n, usual.device.force_step_n);
  add("velocity-share", s.device.velocity_share, usual.device.velocity_share);
  add("blank", s.device.blank_ms, usual.device.blank_ms);
  add("depth", s.script.depth_mm, usual.script.depth_mm);
  add("seconds", s.script.end(), usual.script.end());
  if (!given.empty()) {
    name += '/' + given;
  }
  add("run", repeat, 1);
  std::ranges::replace_if(
      name, [](char c) { return c == ',' || c == '\n' || c == '"'; }, ';');
  return name;
}

std::vector<Settings> runsOf(const Options& options, const fs::path& folder) {
  const std::regex filter(options.filter);
  std::vector<Settings> runs;
  Settings s = options.settings;
  for (int repeat = 1; repeat <= options.repeat; ++repeat) {
    for (const std::string& soil : options.soils) {
      for (const std::string& grip : options.grips) {
        (void)findGrip(grip);
        for (const double delay_ms : options.delays_ms) {
          for (const double step_mm : options.steps_mm) {
            for (const double noise_mm : options.noises_mm) {
              s.soil = sceneOf(soil).empty() ? fs::absolute(soil).string() : soil;
              s.grip = grip;
              s.device.delay_ms = delay_ms;
              s.device.step_mm = step_mm;
              s.device.noise_mm = noise_mm;
              s.name = nameOf(s, options.settings.extra_toml, repeat);
              s.seed = seedOf(s.name, options.seed);
              if (std::regex_search(s.name, filter)) {
                s.folder = (folder / std::to_string(runs.size())).string();
                if (!options.record.empty()) {
                  std::string file = s.name + ".h5";
                  std::ranges::replace_if(
                      file, [](char c) { return c == '/' || c == ' '; }, '_');
                  s.record = (fs::absolute(options.record) / file).string();
                }
                runs.push_back(s);
              }
            }
          }
        }
      }
    }
  }
  return runs;
}

/// Folder that is removed with this object, unless the user keeps it.
class Folder {
 public:
  explicit Folder(const std::string& keep) : kept_(!keep.empty()) {
    if (kept_) {
      fs::create_directories(keep);
      path_ = fs::absolute(keep);
      return;
    }
    std::string name = (fs::temp_directory_path() / "hand_in_the_loop.XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error("cannot make a folder in " + fs::temp_directory_path().string());
    }
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    if (!kept_) {
      fs::remove_all(path_, ignored);
    }
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  bool kept_;
};

void tellLists(const Json& result) {
  if (result.contains("windows")) {
    std::printf("    %8s %10s %8s %10s %10s\n", "from s", "mean up N", "sd N", "largest N", "energy mJ");
    for (const Json& w : result["windows"]) {
      std::printf("    %8.1f %10.3f %8.3f %10.3f %10.2f\n", w["from_s"].get<double>(), w["mean_up_n"].get<double>(),
                  w["sd_n"].get<double>(), w["largest_n"].get<double>(), w["energy_mj"].get<double>());
    }
  }
}

/// Forces on the hand after each kind of glitch.
class GlitchCount {
 public:
  void add(const Json& glitches) {
    for (const Json& glitch : glitches) {
      const auto most = [&glitch](double& x, const char* key) { x = std::max(x, glitch[key].get<double>()); };
      Part& part = parts_[glitch["what"]];
      ++part.all;
      part.let_go += glitch["let_go_ms"].get<double>() >= 0 ? 1 : 0;
      most(part.let_go_ms, "let_go_ms");
      most(part.before_n, "before_n");
      most(part.largest_n, "largest_n");
      part.rise_n = std::max(part.rise_n, glitch["largest_n"].get<double>() - glitch["before_n"].get<double>());
      most(part.step_n_ms, "largest_step_n_ms");
      most(part.torque_nm, "largest_torque_nm");
      most(part.energy_mj, "energy_mj");
    }
  }
  void tell() const {
    std::printf("\nLargest in the 50 ms after:\n%-22s %8s %7s %8s %8s %8s %8s %8s %8s %9s\n", "one packet", "packets",
                "let go", "after ms", "before N", "N", "more N", "N/ms", "N m", "energy mJ");
    for (const auto& [what, p] : parts_) {
      std::printf("%-22s %8d %7d %8.1f %8.2f %8.2f %8.2f %8.2f %8.3f %9.2f\n", what.c_str(), p.all, p.let_go,
                  p.let_go_ms, p.before_n, p.largest_n, p.rise_n, p.step_n_ms, p.torque_nm, p.energy_mj);
    }
  }

 private:
  struct Part {
    int all = 0, let_go = 0;
    double let_go_ms = 0, before_n = 0, largest_n = 0, rise_n = 0, step_n_ms = 0, torque_nm = 0, energy_mj = 0;
  };
  std::map<std::string, Part> parts_;
};

/// Number of stalls with an immediate force on the hand.
class StallCount {
 public:
  void add(const Json& stalls) {
    for (const Json& stall : stalls) {
      const double ms = stall["stopped_ms"].get<double>();
      Part& part = parts_[ms < 10 ? 5 : ms < 30 ? 10 : ms < 100 ? 30 : 100];
      ++part.all;
      part.first += stall["first_n"].get<double>() > kFelt_n ? 1 : 0;
      part.later += stall["largest_n"].get<double>() > kFelt_n ? 1 : 0;
      part.largest_n = std::max(part.largest_n, stall["largest_n"].get<double>());
    }
  }
  void tell() const {
    std::printf("\n%10s %7s %24s %24s %10s\n", "stopped ms", "stalls", "first answer > 0.2 N", "> 0.2 N within 150 ms",
                "largest N");
    Part all;
    for (const auto& [from_ms, part] : parts_) {
      line((std::to_string(from_ms) + " or more").c_str(), part);
      all.all += part.all, all.first += part.first, all.later += part.later;
      all.largest_n = std::max(all.largest_n, part.largest_n);
    }
    line("all", all);
  }

 private:
  static constexpr double kFelt_n = 0.2;
  struct Part {
    int all = 0, first = 0, later = 0;
    double largest_n = 0;
  };
  static void line(const char* what, const Part& part) {
    std::printf("%10s %7d %24d %24d %10.2f\n", what, part.all, part.first, part.later, part.largest_n);
  }
  std::map<int, Part> parts_;
};

/// Plays the runs that are not in the table yet.
/// @returns the exit status: 0, 1 when a run failed to be judged, 130 when interrupted.
int play(const Options& options) {
  if (access(options.settings.program.c_str(), X_OK) != 0) {
    throw std::runtime_error("--program " + options.settings.program + " is no program that can be run");
  }
  const Folder folder(options.keep);
  if (!options.record.empty()) {
    fs::create_directories(options.record);
  }
  Table table(options.csv);
  std::vector<Settings> runs = runsOf(options, folder.path());
  const std::size_t asked = runs.size();
  std::erase_if(runs, [&table](const Settings& s) { return table.has(s.name); });
  if (runs.size() < asked) {
    std::printf("%zu of %zu runs are in %s already\n", asked - runs.size(), asked, options.csv.c_str());
  }
  for (const Settings& s : runs) {
    fs::create_directories(s.folder);
  }
  std::size_t done = 0;
  int failures = 0;
  StallCount stalls;
  GlitchCount glitches;
  const bool whole = playAll(
      runs, options.jobs, options.again, [&](const Settings& s, const Json* result, const std::string& failure) {
        ++done;
        if (result == nullptr) {
          ++failures;
          std::printf("[%zu/%zu] %s: not judged: %s\n", done, runs.size(), s.name.c_str(), failure.c_str());
        } else if (options.json) {
          std::printf("%s\n", result->dump().c_str());
          table.add((*result)["row"]);
        } else {
          table.add((*result)["row"]);
          std::printf("[%zu/%zu] %-26s %s\n", done, runs.size(), s.name.c_str(), lineOf((*result)["row"]).c_str());
          if (result->contains("said")) {
            std::printf("    exit status %s: %s\n", (*result)["row"]["exit_status"].dump().c_str(),
                        (*result)["said"].get<std::string>().c_str());
          }
          tellLists(*result);
          if (!s.record.empty()) {
            std::printf("    recorded in %s\n", s.record.c_str());
          }
          if (result->contains("glitches")) {
            glitches.add((*result)["glitches"]);
          }
          if (result->contains("stalls")) {
            stalls.add((*result)["stalls"]);
          }
        }
        std::fflush(stdout);
      });
  if (!options.json) {
    if (options.settings.task == Task::kStalls) {
      stalls.tell();
    } else if (options.settings.task == Task::kGlitches) {
      glitches.tell();
    } else if (options.settings.task == Task::kHold && table.rows().size() > 1) {
      summarise(table.rows());
    }
  }
  return !whole ? 130 : failures > 0 ? 1 : 0;
}

void addOptions(CLI::App& app, Options& o) {
  Settings& s = o.settings;
  app.add_option("--program", s.program, "haptolith, the program to be judged")->required()->check(CLI::ExistingFile);
  app.add_option("--soils", o.soils,
                 "A paper P3 Moon, B P6 pairwise Earth, C apollo-15-srp, D B virtual; or scene files")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--grips", o.grips, gripNames())->delimiter(',')->capture_default_str();
  app.add_option("--delays", o.delays_ms, "the device's whole delay, ms")->delimiter(',')->capture_default_str();
  app.add_option("--steps", o.steps_mm, "positions are told in steps of this, mm")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--noises", o.noises_mm, "noise of positions, +- mm")->delimiter(',')->capture_default_str();
  const std::map<std::string, DelayAt> places = {
      {"split", DelayAt::kSplit}, {"show", DelayAt::kShow}, {"measure", DelayAt::kMeasure}};
  app.add_option("--delay-at", s.device.delay_at, "split: half at measuring, half at showing; or all at show, measure")
      ->transform(CLI::CheckedTransformer(places));
  app.add_option("--mass", s.handle.mass_kg, "of the handle, kg")->check(CLI::Range(0.01, 10.0))->capture_default_str();
  app.add_option("--damping", s.handle.damping_n_s_m, "the device's own, N s/m")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  app.add_option("--weight", s.weight_n, "of a handle that nobody holds, N")->capture_default_str();
  app.add_option("--handle-weight", s.handle_weight_n, "of the handle, in a hand as well, N")->capture_default_str();
  app.add_option("--jitter", s.device.jitter_ms, "each answer is shown up to so much later, ms")->capture_default_str();
  app.add_option("--drop", s.device.drop, "share of packets and answers that get lost")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--force-step", s.device.force_step_n, "forces are shown in steps of this, N")->capture_default_str();
  app.add_option("--velocity-share", s.device.velocity_share,
                 "smoothing of the told velocity; 1: none, 0: zeros are told")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--blank", s.device.blank_ms, "without answer for so long the device shows nothing, ms; 0: never")
      ->capture_default_str();
  app.add_option("--depth", s.script.depth_mm, "how deep the tool's middle is pressed, mm")->capture_default_str();
  app.add_option("--extra-toml", s.extra_toml,
                 "appended to the scene; ';' begins a line; {delay_ms}, {step_mm}, {noise_mm} are this run's");
  app.add_option("--seconds", o.seconds, "of the whole script; the hold is what is left")
      ->check(CLI::Range(7.0, 3600.0));
  app.add_option("--filter", o.filter, "only runs whose name this regular expression finds");
  app.add_option("--repeat", o.repeat, "each run so often, with other seeds")->check(CLI::PositiveNumber);
  app.add_option("--seed", o.seed, "other random numbers")->capture_default_str();
  app.add_option("--jobs", o.jobs, "runs at a time")->check(CLI::Range(1, 64))->capture_default_str();
  app.add_option("--again", o.again, "a run that failed while the machine was late is played up to so many times more")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  app.add_option("--csv", o.csv, "rows are added to this file; runs that are in it are skipped");
  app.add_flag("--json", o.json, "one JSON object a line instead of text");
  app.add_option("--keep", o.keep, "keep scenes, output and trip files in this folder");
  app.add_option("--record", o.record, "folder for the program's own recordings");
  app.add_option("--most-mj", s.bars.energy_mj, "bar: most energy given to the hand")->capture_default_str();
  app.add_option("--still-mm", s.bars.still_mm,
                 "bar: a smaller vibration need not fall, nor one that the device's steps and noise hide")
      ->capture_default_str();
}

int run(int argc, char** argv) {
  CLI::App app("Plays a person's hand at a haptic device against haptolith, and judges what the hand was given.");
  app.require_subcommand(1);
  std::map<std::string, Options> all;
  const auto command = [&all](const char* name) -> Options& {
    Options& options = all[name];
    options.soils = {"A"};
    options.grips = {"stiff"};
    options.delays_ms = options.steps_mm = options.noises_mm = {0};
    return options;
  };
  Options& one = command("run");
  Options& matrix = command("matrix");
  matrix.soils = {"A", "B", "C"};
  matrix.grips = {"stiff", "firm", "medium", "loose", "none"};
  matrix.delays_ms = {0, 1, 2, 5, 10};
  matrix.steps_mm = {0, 0.02, 0.06};
  matrix.noises_mm = {0, 0.1};
  Options& rest = command("rest");
  rest.grips = {"medium"};
  rest.steps_mm = {0.02, 0.06};
  rest.settings.windows_s = 10;
  rest.settings.script.draw_s = 0;
  rest.settings.script.still_s = 60;
  Options& glitches = command("glitches");
  glitches.settings.task = Task::kGlitches;
  glitches.settings.script.draw_s = 0;
  glitches.count = 9;
  Options& stalls = command("stalls");
  stalls.settings.task = Task::kStalls;
  stalls.settings.script.draw_s = 0;
  stalls.settings.extra_toml = "[safety]; calm_s = 0.2; soft_start_s = 1";

  addOptions(*app.add_subcommand("run", "one run, or several: lists are taken together in all ways"), one);
  addOptions(*app.add_subcommand("matrix", "3 soils, 5 grips, 5 delays, 3 steps, 2 noises: 450 runs"), matrix);
  addOptions(*app.add_subcommand("rest", "a minute at rest in the soil, told in stretches of 10 s"), rest);
  CLI::App* glitches_command = app.add_subcommand("glitches", "single packets that no hand can mean");
  addOptions(*glitches_command, glitches);
  glitches_command->add_option("--count", glitches.count, "packets in each run, of each kind in turn")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI::App* stalls_command = app.add_subcommand("stalls", "the program is stopped for 5 to 500 ms, again and again");
  addOptions(*stalls_command, stalls);
  stalls_command->add_option("--count", stalls.count, "stalls, shared out among --repeat runs")->capture_default_str();
  app.add_subcommand("self-test", "judges stand-ins whose answers are known by paper and pencil");
  CLI11_PARSE(app, argc, argv);

  const std::string chosen = app.get_subcommands().front()->get_name();
  if (chosen == "self-test") {
    return selfTest() == 0 ? 0 : 1;
  }
  Options& options = all[chosen];
  Settings& s = options.settings;
  s.program = fs::absolute(s.program).string();
  if (chosen == "glitches") {
    s.count = options.count;
    s.script.still_s = 5 + 8.0 * s.count;  // maximum; the run ends with the last glitch
  }
  if (chosen == "stalls") {
    constexpr double kMostApart_s = 2.4;  // maximum time between stalls: a stall, recovery of the force, the next stall
    const std::size_t runs = options.soils.size() * options.grips.size() * static_cast<std::size_t>(options.repeat);
    s.count = (options.count + static_cast<int>(runs) - 1) / static_cast<int>(runs);
    s.script.still_s = 5 + kMostApart_s * s.count;
  }
  if (options.seconds > 0) {
    s.script.still_s = options.seconds - (s.script.end() - s.script.still_s);
    if (s.script.still_s < 2) {
      throw std::runtime_error("--seconds leaves less than 2 s of holding still");
    }
  }
  return play(options);
}

}  // namespace
}  // namespace hand_in_the_loop

int main(int argc, char** argv) {
  try {
    return hand_in_the_loop::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hand_in_the_loop: %s\n", error.what());
    return 1;
  }
}

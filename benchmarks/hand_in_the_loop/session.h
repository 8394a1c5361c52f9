#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "device.h"
#include "handle.h"
#include "link.h"
#include "measures.h"

namespace hand_in_the_loop {

using Json = nlohmann::ordered_json;

/// Grip of the person on the handle.
struct Grip {
  const char* name;
  Hand hand;
  /// Time at which the hand opens: never, at contact with the soil, or at the begin of the still hold.
  enum class Opens { kNever, kAtSoil, kWhenStill } opens = Opens::kNever;
};
[[nodiscard]] const Grip& findGrip(const std::string& name);
[[nodiscard]] std::string gripNames();

/// Phases of the person's movement. The tool is pressed down along z and drawn sideways along x.
struct Script {
  double wait_s = 3.1;  ///< wait above the soil, until the program's soft start is over
  double press_s = 0.9, settle_s = 0.4, draw_s = 1.5, still_s = 2.1;
  double surface_mm = 85;  ///< depth of the soil's surface below the device's centre
  double above_mm = 20, depth_mm = 15, draw_mm = 20;

  [[nodiscard]] double end() const { return wait_s + press_s + settle_s + draw_s + still_s; }
  [[nodiscard]] Phase phase(double at_s) const;
};

enum class Task { kHold, kGlitches, kStalls };

struct Settings {
  std::string program;     ///< path of haptolith
  std::string name;        ///< name of this run
  std::string soil = "A";  ///< name in the table in scenes(), or a scene file
  std::string grip = "stiff";
  std::string extra_toml;  ///< appended to the scene
  std::string record;      ///< file for the program's recording; empty: none
  std::string folder;      ///< existing working folder of the program, also for its output
  DeviceParameters device;
  HandleParameters handle;
  double weight_n = 2;         ///< weight of a released handle
  double handle_weight_n = 0;  ///< permanent weight of a handle
  Script script;
  Bars bars;
  Task task = Task::kHold;
  int count = 50;        ///< number of glitches or stalls
  double windows_s = 0;  ///< above 0: the still hold is also reported in windows of this length
  std::uint32_t seed = 1;
};

/// Returns the scene of a built-in soil of this program; empty for another name.
[[nodiscard]] std::string sceneOf(const std::string& soil);

/// Starts the program, plays the hand, and returns the results: "row", one object of columns, and lists "windows",
/// "glitches" and "stalls" if the task has them.
/// @throws std::runtime_error if there is no result: the program cannot be started or never accepts the hand.
[[nodiscard]] Json judgeProgram(const Settings& settings);

/// As judgeProgram(), with the program at this port, in lockstep with its answers instead of the clock. Each packet is
/// answered before time advances, so that a busy machine has no effect.
struct InStep {
  std::uint16_t port;
  /// Target of the person for the handle, instead of the script.
  std::function<Wanted(double)> wanted;
  Hand hand;
  double weight_n = 0;
  double seconds = 5;
  Vec3 start_m;
  /// Called at 1 kHz.
  std::function<void(double, const Handle&)> follow;
};
[[nodiscard]] Measures judgeInStep(const Settings& settings, const InStep& in_step);

}  // namespace hand_in_the_loop

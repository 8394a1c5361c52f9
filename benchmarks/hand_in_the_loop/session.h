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

/// How the person holds the handle.
struct Grip {
  const char* name;
  Hand hand;
  /// When the hand opens: never, when the tool has come to the soil, or when it would hold still.
  enum class Opens { kNever, kAtSoil, kWhenStill } opens = Opens::kNever;
};
[[nodiscard]] const Grip& findGrip(const std::string& name);
[[nodiscard]] std::string gripNames();

/// What the person does, one after the other. The tool goes down along z and is drawn to the side along x.
struct Script {
  double wait_s = 3.1;  ///< above the soil, until the program's soft start is over
  double press_s = 0.9, settle_s = 0.4, draw_s = 1.5, still_s = 2.1;
  double surface_mm = 85;  ///< the soil lies so far below the device's middle
  double above_mm = 20, depth_mm = 15, draw_mm = 20;

  [[nodiscard]] double end() const { return wait_s + press_s + settle_s + draw_s + still_s; }
  [[nodiscard]] Phase phase(double at_s) const;
};

enum class Task { kHold, kGlitches, kStalls };

struct Settings {
  std::string program;     ///< path of haptolith
  std::string name;        ///< of this run
  std::string soil = "A";  ///< of the table in scenes(), or a scene file
  std::string grip = "stiff";
  std::string extra_toml;  ///< appended to the scene
  std::string record;      ///< file for the program's own recording; empty: none
  std::string folder;      ///< where the program runs and its output goes; it exists
  DeviceParameters device;
  HandleParameters handle;
  double weight_n = 2;         ///< of a handle that nobody holds
  double handle_weight_n = 0;  ///< of a handle, always
  Script script;
  Bars bars;
  Task task = Task::kHold;
  int count = 50;        ///< of glitches or stalls
  double windows_s = 0;  ///< above 0: the still hold is also told in windows of this length
  std::uint32_t seed = 1;
};

/// The scene of one of the judge's own soils; the empty string for a name that is none of them.
[[nodiscard]] std::string sceneOf(const std::string& soil);

/// Starts the program, plays the hand, and tells what it was given: "row", one object of columns, and lists "windows",
/// "glitches" and "stalls" where the task has them.
/// @throws std::runtime_error when there is nothing to judge: the program cannot be started or never takes the hand.
[[nodiscard]] Json judgeProgram(const Settings& settings);

/// The same against the program that answers at that port, in step with the answers instead of the clock: each packet
/// has its answer before time goes on, so that a busy machine changes nothing.
struct InStep {
  std::uint16_t port;
  /// Where the person wants the handle, instead of the script.
  std::function<Wanted(double)> wanted;
  Hand hand;
  double weight_n = 0;
  double seconds = 5;
  Vec3 start_m;
  /// Called each millisecond.
  std::function<void(double, const Handle&)> follow;
};
[[nodiscard]] Measures judgeInStep(const Settings& settings, const InStep& in_step);

}  // namespace hand_in_the_loop

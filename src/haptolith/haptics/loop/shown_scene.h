#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "haptolith/core/process/latest_value.h"
#include "haptolith/core/vec.h"
#include "haptolith/haptics/safety/safety_layer.h"
#include "haptolith/scene/scene.h"

namespace haptolith {

/// Ticks between two snapshots: 62 a second at 1 kHz.
inline constexpr std::size_t kTicksPerSnapshot = 16;

/// A tool in a picture of the scene.
struct ShownTool {
  Pose scene_T_tool;     ///< its hub's, if it has a joint
  Pose turned;           ///< as its joint has turned it: where its shape is
  double opening_m = 0;  ///< between jaws
  JointState joint;
  // Values of the last tick, also while time is paused and the device is sent zero.
  Wrench soil_wrench;                      ///< soil on tool, about the tool's origin, scene frame, unfiltered
  std::optional<ForceRange> force_band{};  ///< Scene::forceBand()
  Wrench device_wrench_in_scene;           ///< device wrench in scene axes, with the device's magnitude
  SafetyTrip trip = SafetyTrip::kNone;     ///< why its hand feels nothing just now
};

/// A picture of the scene for viewers, about 60 times a second. Each tick copies a part of a large bed, so
/// that no tick is long: its first particles are then 15 ticks older than its last. Only what has changed is copied.
struct SceneSnapshot {
  double time_s = 0;
  Pose scene_T_tool;
  double opening_m = 0;  ///< between the tool's jaws
  // Values of the last tick, also while time is paused and the device is sent zero.
  Wrench soil_wrench;                ///< soil on tool, about the tool's origin, scene frame, unfiltered
  Wrench device_wrench;              ///< sent to the device, about the handle's origin, device frame
  Wrench device_wrench_in_scene;     ///< device wrench in scene axes, with the device's magnitude
  std::vector<Float4> position;      ///< m; one per particle
  std::vector<Pose> stones;          ///< scene_T_stone of each
  std::vector<std::uint8_t> asleep;  ///< one per group of kGroup particles, 1 when it sleeps: see Wakefulness
  std::uint64_t ticks = 0, deadline_misses = 0;
  std::uint64_t misses_too_long = 0, misses_woken_late = 0, misses_preempted = 0;  ///< add up to deadline_misses
  double success_rate = 1, tick_us_p50 = 0, tick_us_p99 = 0, tick_us_max = 0, largest_speed_m_s = 0;
  double tick_us_lately = 0;  ///< the longest tick since the snapshot before
  std::size_t awake = 0;      ///< particles that are worked on
  bool paused = false;
  SafetyTrip trip = SafetyTrip::kNone;                       ///< why the hand feels nothing just now
  std::uint32_t trips = 0;                                   ///< so far
  std::vector<ShownTool> tools;                              ///< each of them, also the first
  std::array<std::uint64_t, kTicksPerSnapshot> copied_at{};  ///< Bed::changes() when each part was copied
};

/// A scene as a loop shows it: with the place where its pictures are handed over.
struct ShownScene {
  explicit ShownScene(Scene& shown);

  Scene& scene;
  LatestValue<SceneSnapshot> snapshots;
};

}  // namespace haptolith

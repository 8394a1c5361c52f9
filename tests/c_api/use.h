#pragma once

#include <gmock/gmock.h>
#include <haptolith/haptolith.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace haptolith::library {

/// The last error of this thread.
inline hapto_error lastError() {
  hapto_error error{};
  error.size = sizeof error;
  EXPECT_EQ(hapto_last_error(&error), HAPTO_OK);
  return error;
}

/// Expects HAPTO_OK, or reports the error.
inline void expectOk(std::int32_t status) {
  EXPECT_EQ(status, HAPTO_OK) << lastError().message;
}

/// A struct with its size in it.
template <class T>
T sized() {
  T value{};
  value.size = sizeof value;
  return value;
}

struct Destroy {
  void operator()(hapto_scene* scene) const { expectOk(hapto_scene_destroy(scene)); }
  void operator()(hapto_soil* soil) const { expectOk(hapto_soil_destroy(soil)); }
  void operator()(hapto_result* result) const { expectOk(hapto_result_destroy(result)); }
  void operator()(hapto_batch* batch) const { expectOk(hapto_batch_destroy(batch)); }
  void operator()(hapto_loop* loop) const { expectOk(hapto_loop_destroy(loop)); }
  void operator()(hapto_safety* safety) const { expectOk(hapto_safety_destroy(safety)); }
};
using ScenePtr = std::unique_ptr<hapto_scene, Destroy>;
using LoopPtr = std::unique_ptr<hapto_loop, Destroy>;
using SoilPtr = std::unique_ptr<hapto_soil, Destroy>;
using ResultPtr = std::unique_ptr<hapto_result, Destroy>;

/// A few hundred macroparticles with ICRA 2021 friction, or with contact friction, cohesion and a spread of sizes.
inline constexpr const char* kIcra2021 = "[bed]\nparticles = 256\n";
inline constexpr const char* kContact =
    "[soil]\nname = 'lunar-0-15cm'\n[bed]\nstart = 'packed'\nwidth_mm = 126\nlength_mm = 84\ndepth_mm = 40\n";

inline ScenePtr sceneOf(const char* toml, const std::vector<const char*>& overrides = {}) {
  hapto_scene* scene = nullptr;
  expectOk(hapto_scene_from_toml(toml, nullptr, overrides.data(), static_cast<std::uint32_t>(overrides.size()), nullptr,
                                 nullptr, &scene));
  return ScenePtr(scene);
}

inline SoilPtr soilOf(const char* name) {
  hapto_soil* soil = nullptr;
  expectOk(hapto_soil_find(name, &soil));
  return SoilPtr(soil);
}

/// Pose at a tick of a tool that digs in circles.
inline hapto_pose stirring(int tick) {
  const double angle = 2 * M_PI * tick / 500.0;
  const double depth_m = 0.02 * (1 - std::cos(angle / 3));
  return {{0.02 * std::sin(angle), 0.015 * std::cos(angle) - 0.015, 0.055 - depth_m}, {1, 0, 0, 0}};
}

inline std::uint64_t hashOf(const hapto_scene* scene) {
  std::uint64_t hash = 0;
  expectOk(hapto_scene_state_hash(scene, &hash));
  return hash;
}

/// Ticks first to last - 1 of stirring(); the sum of forces.
inline double stir(hapto_scene* scene, int first, int last) {
  double sum_n = 0;
  for (int tick = first; tick < last; ++tick) {
    const hapto_pose pose = stirring(tick);
    hapto_wrench felt{};
    expectOk(hapto_scene_step(scene, &pose, nullptr, &felt));
    sum_n += std::abs(felt.force_n[2]);
  }
  return sum_n;
}

}  // namespace haptolith::library

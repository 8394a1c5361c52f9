// Overhead of the C interface: a step through it compared with a direct step of the scene, and a batch of scenes
// compared with separate threads. Prints medians of interleaved rounds.

#include <fmt/format.h>
#include <haptolith/haptolith.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "haptolith/scene/scene.h"
#include "haptolith/scene_file/scene_file.h"

namespace {

using namespace haptolith;
using Clock = std::chrono::steady_clock;

void require(std::int32_t status) {
  if (status != HAPTO_OK) {
    fmt::print(stderr, "{}\n", hapto_status_text(status));
    std::exit(1);
  }
}

double secondsOf(const std::function<void()>& work) {
  const auto begin = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

hapto_scene* cScene(const std::string& toml) {
  hapto_scene* scene = nullptr;
  require(hapto_scene_from_toml(toml.c_str(), nullptr, nullptr, 0, nullptr, nullptr, &scene));
  return scene;
}

std::unique_ptr<Scene> ownScene(const std::string& toml) {
  const SceneFile scene_file = sceneFileFromText(toml, "scene");
  return std::make_unique<Scene>(scene_file.bed, scene_file.tool);
}

/// Returns the tool's pose at a tick: back and forth through the upper soil.
hapto_pose poseAt(int tick) {
  return {{0.03 * std::sin(tick * 2e-3), 0.02 * std::cos(tick * 2e-3), 0.03}, {1, 0, 0, 0}};
}

HandState handAt(int tick) {
  const hapto_pose pose = poseAt(tick);
  HandState hand;
  hand.pose.position_m = Vec3::Map(pose.position_m);
  return hand;
}

/// Times a step of a small number of sleeping particles without contact, which is almost only the call's overhead.
void callCost() {
  const std::string toml = "[bed]\nparticles = 16\nlayers = 1\n";
  hapto_scene* const scene = cScene(toml);
  const auto own = ownScene(toml);
  const hapto_pose above{{0, 0, 0.3}, {1, 0, 0, 0}};
  const hapto_twist still{};
  HandState hand;
  hand.pose.position_m = {0, 0, 0.3};
  constexpr int kSteps = 20'000;
  std::vector<double> through_c;
  std::vector<double> inside;
  for (int round = 0; round < 31; ++round) {
    inside.push_back(secondsOf([&] {
      for (int i = 0; i < kSteps; ++i) {
        (void)own->tick(hand);
      }
    }));
    through_c.push_back(secondsOf([&] {
      hapto_wrench felt;
      for (int i = 0; i < kSteps; ++i) {
        require(hapto_scene_step(scene, &above, &still, &felt));
      }
    }));
  }
  const double each = 1e6 / kSteps;
  fmt::print("step of 16 sleeping particles: {:.3f} us inside, {:.3f} us through C: {:+.3f} us\n",
             median(inside) * each, median(through_c) * each, (median(through_c) - median(inside)) * each);
  require(hapto_scene_destroy(scene));
}

void batch(int scenes, int threads) {
  const std::string toml;  // the scene of icra2021
  constexpr int kTicks = 200;
  std::vector<hapto_scene*> handles;
  std::vector<std::unique_ptr<Scene>> own;
  std::vector<hapto_pose> poses;
  for (int i = 0; i < scenes; ++i) {
    handles.push_back(cScene(toml));
    own.push_back(ownScene(toml));
    for (int t = 0; t < kTicks; ++t) {
      poses.push_back(poseAt(t));
    }
  }
  hapto_batch* made = nullptr;
  require(hapto_batch_create(handles.data(), static_cast<std::uint32_t>(scenes), static_cast<std::uint32_t>(threads),
                             &made));
  std::vector<double> batched;
  std::vector<double> inside;
  for (int round = 0; round < 15; ++round) {
    inside.push_back(secondsOf([&] {
      std::vector<std::thread> workers;
      for (int w = 0; w < threads; ++w) {
        workers.emplace_back([&, w] {
          for (int i = w; i < scenes; i += threads) {
            for (int t = 0; t < kTicks; ++t) {
              (void)own[static_cast<std::size_t>(i)]->tick(handAt(t));
            }
          }
        });
      }
      for (std::thread& worker : workers) {
        worker.join();
      }
    }));
    batched.push_back(
        secondsOf([&] { require(hapto_batch_step(made, kTicks, poses.data(), nullptr, nullptr, nullptr)); }));
  }
  const double steps = static_cast<double>(own[0]->bed().particles()) * scenes * kTicks * own[0]->substeps() / 1e6;
  fmt::print("{} icra2021 scenes on {} threads: {:.1f} M particle-steps/s inside, {:.1f} in a batch: {:.0f} %\n",
             scenes, threads, steps / median(inside), steps / median(batched), 100 * median(inside) / median(batched));
  require(hapto_batch_destroy(made));
  for (hapto_scene* scene : handles) {
    require(hapto_scene_destroy(scene));
  }
}

}  // namespace

int main() {
  callCost();
  batch(64, 1);
  batch(64, 2);
  return 0;
}

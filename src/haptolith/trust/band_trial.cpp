#include "haptolith/trust/band_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/trust/moving_scene.h"

namespace haptolith {

namespace {

constexpr std::uint64_t kScenesPerSeed = 150;

/// Mean force in each window of a movement that the soil does not change.
std::vector<MeanForce> meansOf(const TrustRun& run, int threads, const TrustProgress& progress) {
  MovingScene movement(run, threads, progress);
  Scene& scene = movement.scene();
  const double tick_s = run.scene.bed.tick_s;
  const auto length = static_cast<std::size_t>(std::lround(RecentForce::kWindow_s / tick_s));
  const auto windows = static_cast<std::size_t>(run.scene.hand.period_s / RecentForce::kWindow_s);
  scene.placeTool(movement.nextMovements().front());
  std::vector<MeanForce> means(windows);
  for (std::size_t window = 0; window < windows; ++window) {
    for (std::size_t tick = 0; tick < length; ++tick) {
      if (scene.tickAll(movement.nextMovements()) != StepStatus::kOk) {
        throw Failure("the movement could not be rendered");
      }
      means[window].force_n += scene.soilWrench().force_n.norm() / static_cast<double>(length);
      means[window].contacts +=
          scene.contactStiffness().trace() / scene.tool().stiffness_n_m / static_cast<double>(length);
    }
    if (progress && !progress("the tool moves", static_cast<double>(window + 1) / static_cast<double>(windows))) {
      throw Failure("interrupted");
    }
  }
  return means;
}

TrustRun specimenOf(const SceneFile& scene, TrustChange change, std::size_t specimen) {
  PlannedRun run = planned(scene, change, specimen, change == TrustChange::kRadius ? 0.5 : 1);
  if (!run.run) {
    throw Failure(run.why_not);
  }
  return *std::move(run.run);
}

}  // namespace

SceneFile bandScene(std::uint64_t number) {
  std::mt19937_64 random(number);
  random.discard(16);
  const auto between = [&](double low, double high) { return low + (high - low) * (uniformSigned(random) + 1) / 2; };
  const auto evenly = [&](double low, double high) { return low * std::pow(high / low, between(0, 1)); };
  const auto one_of = [&](std::size_t count) {
    return static_cast<std::size_t>(between(0, static_cast<double>(count)));
  };
  struct Kind {
    const char* soil;
    const char* body;
  };
  static constexpr auto kKinds = std::to_array<Kind>({{"lunar-0-15cm", "Moon"},
                                                      {"lunar-trafficability", "Moon"},
                                                      {"surveyor-3", "Moon"},
                                                      {"apollo-15-srp", "Moon"},
                                                      {"grc-1", "Earth"},
                                                      {"jsc-1a", "Earth"},
                                                      {"lhs-1", "Moon"},
                                                      {"lms-1", "Earth"},
                                                      {"mars-cloddy", "Mars"},
                                                      {"mars-drift", "Mars"},
                                                      {"ottawa-f65", "Earth"},
                                                      {"soft-sand", "Earth"},
                                                      {"soft-sand", "Moon"},
                                                      {"toyoura", "Moon"},
                                                      {"dry-sand", "Earth"}});
  const Kind& kind = kKinds.at(number % kKinds.size());
  static constexpr std::array<const char*, 6> kMotions{"press", "stir", "cut", "scoop", "shake", "furrows"};
  const char* motion = kMotions.at(one_of(kMotions.size()));
  constexpr double kRadius_mm = 4;
  const double width_mm = kRadius_mm * evenly(4, 10);
  const double period_s = between(1.5, 3);
  const double depth_mm = width_mm * between(0.1, 0.5);
  const double reach_mm = width_mm * between(0.3, 0.9);
  std::string tool;
  double half_mm = 0;  // from its middle to its lowest point
  switch (one_of(4)) {
    case 0:
      tool = fmt::format("shape = \"sphere\"\ndiameter_mm = {:.4g}\n", width_mm);
      half_mm = width_mm / 2;
      break;
    case 1:
      tool = fmt::format("shape = \"plate\"\ndiameter_mm = {:.4g}\nthickness_mm = {:.4g}\n", width_mm,
                         std::max(2.0, 0.1 * width_mm));
      half_mm = width_mm / 4;
      break;
    default: {
      const double length_mm = width_mm * between(0.5, 1.2);
      tool = fmt::format("shape = \"box\"\nsize_mm = [{:.4g}, {:.4g}, {:.4g}]\n", length_mm, width_mm,
                         width_mm * between(0.08, 0.5));
      half_mm = length_mm / 2;
    }
  }
  constexpr double kMostDepth_mm = 34;  // soil is 48 mm deep
  const double deepest_mm = std::min(depth_mm + half_mm, kMostDepth_mm);
  const double side_mm = 2 * (reach_mm + 0.6 * width_mm + 0.7 * deepest_mm);
  const std::string text = fmt::format(
      "[tool]\n{}[soil]\nname = \"{}\"\nradius_mm = {}\n[gravity]\nbody = \"{}\"\n[bed]\nstart = \"settled\"\n"
      "width_mm = {:.5g}\nlength_mm = {:.5g}\ndepth_mm = {}\nsleep_speed_m_s = 1e-2\nsleep_distance_mm = {}\n"
      "seed = {}\n[hand]\nmotion = \"{}\"\ncompliance = \"rigid\"\nperiod_s = {:.4g}\ndepth_mm = {:.4g}\n"
      "reach_mm = {:.4g}\nhome_mm = [0, 0, {:.4g}]\n",
      tool, kind.soil, kRadius_mm, kind.body, side_mm, side_mm, 12 * kRadius_mm, kRadius_mm / 100,
      1 + 100 * (number / kScenesPerSeed), motion, period_s, deepest_mm - half_mm, reach_mm, 1.2 * half_mm + 5);
  return sceneFileFromText(text, fmt::format("random scene {}", number));
}

std::string bandSceneName(const SceneFile& scene) {
  return fmt::format("{}, {}", scene.soil_name, wordFor(kHandMotionWords, scene.hand.motion));
}

std::vector<BandWindow> bandTrial(const SceneFile& scene, int threads, const TrustProgress& progress) {
  constexpr std::array<std::size_t, 2> kOthers{10, 11};  // numbers of specimens
  const auto part = [&](std::size_t of_3) -> TrustProgress {
    return [&progress, of_3](std::string_view what, double fraction) {
      return !progress || progress(what, (static_cast<double>(of_3) + fraction) / 3);
    };
  };
  const std::vector<MeanForce> means = meansOf(specimenOf(scene, TrustChange::kNone, 0), threads, part(0));
  std::vector<double> references_n(means.size());
  for (std::size_t i = 0; i < kOthers.size(); ++i) {
    const std::vector<MeanForce> others =
        meansOf(specimenOf(scene, TrustChange::kRadius, kOthers.at(i)), threads, part(1 + i));
    for (std::size_t window = 0; window < means.size(); ++window) {
      references_n[window] += others.at(window).force_n / static_cast<double>(kOthers.size());
    }
  }
  const SoilParameters& soil = scene.bed.soil;
  const double gravity_m_s2 = scene.bed.gravity_m_s2.norm();
  const double least_n = 0.5 * particleForce(soil, gravity_m_s2);
  std::vector<BandWindow> windows;
  for (std::size_t window = 0; window < means.size(); ++window) {
    const std::optional<ForceRange> band = forceRange(means[window], soil, gravity_m_s2);
    if (band && std::max(means[window].force_n, references_n[window]) > least_n) {
      windows.push_back({means[window], references_n[window], particleForce(soil, gravity_m_s2), *band});
    }
  }
  return windows;
}

}  // namespace haptolith

// Maximum frequencies of beds of the named soils, and the fraction of the stable step that 3, 4 and 5 substeps per
// millisecond use. The beds are settled, sheared under load, under a hard-pressed plate, and under a shovel that stirs,
// scoops and presses with 12 N.
//
//     build/release/benchmarks/haptolith_step                        # all named soils
//     build/release/benchmarks/haptolith_step --soil dry-sand --body Earth

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/bed/critical_step.h"
#include "haptolith/core/error.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/lab/apparatus/contact_network.h"
#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/soil/bodies.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
constexpr std::array kSubsteps{3, 4, 5};
constexpr double kLook_s = 0.02;

struct Place {
  SoilParameters soil;
  double gravity_m_s2 = 0;
  int ticks_per_ms = 1;  ///< above 1: shorter steps than with a tick of 1 ms
};

/// Maximum of each quantity.
struct Seen {
  double touching = 0;                           ///< overlapping contacts per particle, mean
  double most_touching = 0;                      ///< overlapping contacts per particle, maximum
  std::array<double, 3> frequency{};             ///< maximum m omega^2 / k with k_t / k = 0, the soil's ratio, and 1
  std::array<double, kSubsteps.size()> share{};  ///< fraction of the stable step
  double warmth_m_s = 0;                         ///< root mean square speed, 1 s after the tool stopped

  void add(const Seen& other) {
    touching = std::max(touching, other.touching);
    most_touching = std::max(most_touching, other.most_touching);
    warmth_m_s = std::max(warmth_m_s, other.warmth_m_s);
    const auto larger = [](double a, double b) { return std::max(a, b); };
    std::ranges::transform(frequency, other.frequency, frequency.begin(), larger);
    std::ranges::transform(share, other.share, share.begin(), larger);
  }

  void look(const Bed& bed, const ToolParameters* tool = nullptr, const Pose& pose = {}) {
    const SoilParameters& soil = bed.parameters().soil;
    ContactNetwork network = contactNetwork(bed);
    std::vector<double> contacts(bed.particles());
    double inside = 0;
    for (const ContactLink& link : network.links) {
      const double least = 0.5 * soil.stiffness_n_m;
      if (link.stiffness_n_m.along > least) {
        contacts[static_cast<std::size_t>(link.first)] += 1;
        inside += 1;
        if (link.second >= 0) {
          contacts[static_cast<std::size_t>(link.second)] += 1;
          inside += 1;
        }
      }
    }
    touching = std::max(touching, inside / static_cast<double>(bed.particles()));
    most_touching = std::max(most_touching, std::ranges::max(contacts));
    const double per_k = bed.mass() / soil.stiffness_n_m;
    const ContactNetwork as_it_is = network;
    const auto with_ratio = [&](double ratio) {
      ContactNetwork other = as_it_is;
      for (ContactLink& link : other.links) {
        link.stiffness_n_m.across *= ratio / soil.tangential_ratio;
      }
      return largestFrequencySquared(other) * per_k;
    };
    frequency[0] = std::max(frequency[0], with_ratio(0));
    frequency[1] = std::max(frequency[1], with_ratio(soil.tangential_ratio));
    frequency[2] = std::max(frequency[2], with_ratio(1));
    for (std::size_t i = 0; i < kSubsteps.size(); ++i) {
      ContactNetwork with_tool = as_it_is;
      const double dt_s = kTick_s / kSubsteps[i];
      if (tool != nullptr) {
        addTool(with_tool, *tool, pose, dt_s, bed);
      }
      share[i] = std::max(share[i], shareOfStableStep(with_tool, dt_s));
    }
  }
};

/// Returns a bed after rain, or as a crystal.
BedParameters bedOf(const Place& place, int particles, BedStart start = BedStart::kRain) {
  BedParameters bed;
  bed.soil = place.soil;
  bed.gravity_m_s2 = {0, 0, -place.gravity_m_s2};
  bed.start = start;
  bed.depth_m = 0.04;
  bed.particles = particles;
  bed.sleep = false;
  bed.tick_s = kTick_s / place.ticks_per_ms;
  return bed;
}

/// Returns the root mean square speed of all particles.
double speedOf(const Bed& bed) {
  double squares = 0;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Float4& v = bed.state().velocity[i];
    squares += v.x * v.x + v.y * v.y + v.z * v.z;
  }
  return std::sqrt(squares / static_cast<double>(bed.particles()));
}

Seen settled(const Place& place) {
  Seen seen;
  seen.look(Bed(bedOf(place, 1000)));
  return seen;
}

/// Shears soil between two rough plates, the upper one drawn at 50 mm/s and under a stress above that of all tests.
Seen pressed(const Place& place, double stress_pa) {
  const double d = 2 * place.soil.radius_m;
  const LabBox box{.width_m = 8 * d, .length_m = 8 * d};
  const LabConditions conditions{.soil = place.soil, .gravity_m_s2 = place.gravity_m_s2};
  const std::vector<Vec3> loose = looseSoil(place.soil, box, 600, d, 1);
  LabBed lab(conditions, box, loose, {roughPlate(place.soil, box, loose.back().z() + 2.5 * d, 2)});
  lab.settle();
  Seen seen;
  const double carried_n = stress_pa * box.width_m * box.length_m;
  lab.moveBody(0, {0, 0, -0.1});
  lab.run(kLook_s, "the plate comes down");
  for (int look = 0; look < 4000 && lab.forceOnBody(0).z() < carried_n; ++look) {
    lab.run(kLook_s / 20, "the plate is pressed");
  }
  for (int look = 0; look < 10; ++look) {
    seen.look(lab.bed());
    lab.moveBody(0, {0.05, 0, 0});
    lab.run(kLook_s, "the plate is drawn");
  }
  lab.moveBody(0, Vec3::Zero());
  lab.run(1, "the plate stands still");
  seen.warmth_m_s = speedOf(lab.bed());
  return seen;
}

Seen inTheHand(const Place& place, HandMotion motion) {
  const BedParameters bed = bedOf(place, 400);
  Scene scene(bed, ToolParameters{});
  HandParameters hand;
  hand.motion = motion;
  hand.surface_m = scene.bed().surfaceHeight();
  VirtualHand device(hand, bed.tick_s);
  LoopParameters loop_parameters;
  loop_parameters.real_time = false;
  loop_parameters.tick_s = bed.tick_s;
  HapticLoop loop(scene, device, loop_parameters, false);
  Seen seen;
  for (int tick = 0; tick < 8000 * place.ticks_per_ms; ++tick) {
    if (loop.tick() != LoopEnd::kRunning) {
      throw Failure("the loop has ended");
    }
    if (tick % (50 * place.ticks_per_ms) == 0 && scene.soilWrench().force_n.norm() > 0) {
      seen.look(scene.bed(), &scene.tool(), scene.toolPose());
    }
  }
  return seen;
}

/// Tool as a body with an arm's mass and damping, pressed down.
struct Pressing {
  ToolParameters tool{};
  Quat orientation = Quat::Identity();
  Vec3 over_m = Vec3::Zero();  ///< x and y; z above the surface
  double force_n = 12;         ///< maximum force of the virtual hand, and of a sigma.7
  BedStart start = BedStart::kRain;
  int particles = 400;
};

Seen pressedWith(const Place& place, const Pressing& pressing) {
  Scene scene(bedOf(place, pressing.particles, pressing.start), pressing.tool);
  HandState hand;
  hand.pose = {pressing.over_m + Vec3(0, 0, scene.bed().surfaceHeight()), pressing.orientation};
  scene.placeTool(hand);
  constexpr double kMass_kg = 0.554, kDamping_n_s_m = 20;
  Seen seen;
  const double tick_s = kTick_s / place.ticks_per_ms;
  const int ticks = 4000 * place.ticks_per_ms;
  int looked = 0;
  for (int tick = 0; tick < ticks; ++tick) {
    if (scene.tick(hand) != StepStatus::kOk) {
      throw Failure("the bed is no longer sound");
    }
    double& speed = hand.twist.linear_m_s.z();
    speed += tick_s / kMass_kg * (scene.soilWrench().force_n.z() - pressing.force_n - kDamping_n_s_m * speed);
    hand.pose.position_m.z() += tick_s * speed;
    if (tick % (50 * place.ticks_per_ms) == 0) {
      seen.look(scene.bed(), &scene.tool(), scene.toolPose());
      if (tick > ticks * 3 / 4) {
        seen.warmth_m_s += speedOf(scene.bed());
        ++looked;
      }
    }
  }
  seen.warmth_m_s /= looked;
  return seen;
}

struct State {
  const char* name;
  std::function<Seen(const Place&)> measure;
};

void print(const std::string& soil, const std::string& bed, const Seen& seen, int substeps) {
  std::printf("| %s | %s | %.1f | %.0f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %d | %.2g |\n", soil.c_str(),
              bed.c_str(), seen.touching, seen.most_touching, seen.frequency[0], seen.frequency[1], seen.frequency[2],
              seen.share[0], seen.share[1], seen.share[2], substeps, 1e3 * seen.warmth_m_s);
}

int run(int argc, char** argv) {
  std::vector<std::string> soils = soilNames();
  std::string body = "Moon";
  double size_spread = -1;
  int ticks_per_ms = 1;
  std::string only;
  CLI::App app("How fast beds can swing, and how much of the stable step their substeps take.");
  app.add_option("--soil", soils, "named soils")->delimiter(',');
  app.add_option("--body", body, "where");
  app.add_option("--size-spread", size_spread, "of the particles' radii [the soil's]");
  app.add_option("--ticks-per-ms", ticks_per_ms, "for shorter steps");
  app.add_option("--only", only, "beds whose names hold this");
  CLI11_PARSE(app, argc, argv);
  const std::vector<State> states{
      {"settled", settled},
      {"plate, 3 kPa", [](const Place& p) { return pressed(p, 3e3); }},
      {"plate, 10 kPa", [](const Place& p) { return pressed(p, 1e4); }},
      {"plate, 30 kPa", [](const Place& p) { return pressed(p, 3e4); }},
      {"plate, 60 kPa", [](const Place& p) { return pressed(p, 6e4); }},
      {"stirred", [](const Place& p) { return inTheHand(p, HandMotion::kStir); }},
      {"scooped", [](const Place& p) { return inTheHand(p, HandMotion::kScoop); }},
      {"shovel flat, 12 N",
       [](const Place& p) {
         return pressedWith(p, {.over_m = {0, 0, 0.005}});
       }},
      {"shovel on edge, 12 N",
       [](const Place& p) {
         return pressedWith(
             p, {.orientation = Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX())), .over_m = {0, 0, 0.025}});
       }},
      {"shovel in a corner, 12 N",
       [](const Place& p) {
         return pressedWith(p, {.over_m = {0.036, 0.041, 0.005}});
       }},
      {"ball of 20 mm, 12 N",
       [](const Place& p) {
         return pressedWith(p, {.tool = {.shape = ToolShape::kSphere, .diameter_m = 0.02}, .over_m = {0, 0, 0.015}});
       }},
      {"icra2021, 256, shovel flat, 12 N",
       [](const Place& p) {
         return pressedWith(p, {.over_m = {0, 0, 0.005}, .start = BedStart::kCount, .particles = 256});
       }},
      {"close packing, shovel flat, 12 N",
       [](const Place& p) {
         return pressedWith(p, {.over_m = {0, 0, 0.005}, .start = BedStart::kPacked});
       }},
      {"close packing, shovel flat, 40 N",
       [](const Place& p) {
         return pressedWith(p, {.over_m = {0, 0, 0.005}, .force_n = 40, .start = BedStart::kPacked});
       }},
      {"shovel flat, 40 N",
       [](const Place& p) {
         return pressedWith(p, {.over_m = {0, 0, 0.005}, .force_n = 40});
       }},
      {"shovel flat, 100 N",
       [](const Place& p) {
         return pressedWith(p, {.over_m = {0, 0, 0.005}, .force_n = 100});
       }},
  };
  std::printf(
      "| soil | bed | Z, mean | Z, most | m omega^2/k: k_t = 0 | as it is | k_t = k | share at 3 | at 4 | at 5 | "
      "substeps | at rest / (mm/s) "
      "|\n|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  std::map<std::string, Seen> most;
  int fewest = 1000;
  for (const std::string& name : soils) {
    Place place{findSoil(name).soil, findBody(body).gravity_m_s2, ticks_per_ms};
    place.soil.size_spread = size_spread < 0 ? place.soil.size_spread : size_spread;
    for (const State& state : states) {
      if (std::string_view(state.name).find(only) == std::string_view::npos) {
        continue;
      }
      const Seen seen = state.measure(place);
      const int substeps =
          place.ticks_per_ms * substepsFor(place.soil, stiffnessInStep(ToolParameters{}, place.soil.friction),
                                           kTick_s / place.ticks_per_ms, 1000);
      print(name, state.name, seen, substeps);
      most[state.name].add(seen);
      fewest = std::min(fewest, substeps);
      std::fflush(stdout);
    }
  }
  for (const State& state : states) {
    if (soils.size() > 1 && most.contains(state.name)) {
      print("most of all", state.name, most[state.name], fewest);
    }
  }
  return 0;
}

}  // namespace
}  // namespace haptolith

int main(int argc, char** argv) {
  try {
    return haptolith::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "haptolith_step: %s\n", error.what());
    return 1;
  }
}

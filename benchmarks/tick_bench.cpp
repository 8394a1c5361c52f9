// Duration of a tick's work and of its parts. ./dev bench --benchmark_filter=Icra2021Scene
//
// Percentiles are over single ticks, not over means of many, because the worst tick matters for a hand.

#include <benchmark/benchmark.h>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/histogram.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/scene/scene.h"
#include "haptolith/tool/tool_contact.h"

namespace haptolith {
namespace {

/// Returns a bed of about `particles`, close-packed, in a square box half as deep as wide: 1.8 cm^3 per particle.
BedParameters bedOf(std::int64_t particles) {
  BedParameters bed;
  bed.sleep = false;  // otherwise the bed would soon be asleep
  if (particles == 256) {
    return bed;  // the scene of icra2021
  }
  const double side = 0.0153 * std::cbrt(static_cast<double>(particles));
  bed.start = BedStart::kPacked;
  bed.width_m = bed.length_m = side;
  bed.depth_m = side / 2;
  return bed;
}

/// Times the complete tick of the loop (read, move, step, sum, filter, limit, send, publish), one thread.
void Icra2021Scene(benchmark::State& state, HandMotion motion) {
  Scene scene(bedOf(256), ToolParameters{});
  HandParameters hand;
  hand.motion = motion;
  hand.surface_m = scene.bed().surfaceHeight();
  VirtualHand device(hand, 1e-3);
  HapticLoop loop(scene, device, LoopParameters{}, false);
  for (auto _ : state) {
    if (loop.tick() != LoopEnd::kRunning) {
      state.SkipWithError("the loop ended");
      break;
    }
  }
  const Histogram& tick_us = loop.statistics().tickUs();
  state.counters["p50_us"] = tick_us.percentile(0.5);
  state.counters["p99_us"] = tick_us.percentile(0.99);
  state.counters["p99.9_us"] = tick_us.percentile(0.999);
  state.counters["max_us"] = tick_us.max();
  state.counters["rebuilds_per_tick"] =
      static_cast<double>(scene.bed().listRebuilds()) / static_cast<double>(loop.statistics().ticks());
}
// 20 s of simulated time each, for percentiles that do not depend on the machine's speed.
BENCHMARK_CAPTURE(Icra2021Scene, stir, HandMotion::kStir)->Iterations(20000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Icra2021Scene, scoop, HandMotion::kScoop)->Iterations(20000)->Unit(benchmark::kMicrosecond);

/// Times one step of a bed at rest: contacts, friction, positions.
void BedStep(benchmark::State& state) {
  Bed bed(bedOf(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(bed.step(1e-3));
  }
  state.SetLabel(simdTarget());
  state.counters["particles"] = static_cast<double>(bed.particles());
  state.counters["particle_steps"] = benchmark::Counter(
      static_cast<double>(bed.particles()) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(BedStep)->Arg(256)->Arg(2000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMicrosecond);

/// Times building all neighbour lists from scratch.
void EnterAll(benchmark::State& state) {
  Bed bed(bedOf(state.range(0)));
  const BedParameters& box = bed.parameters();
  Neighbourhood neighbourhood(bed.particles(), {.reach_m = bed.law().cutoff_m + 3.5e-3},
                              {box.width_m, box.length_m, bed.surfaceHeight(), {}});
  ContactLists lists(bed.particles(), false);
  for (auto _ : state) {
    lists.clear();
    benchmark::DoNotOptimize(neighbourhood.buildAll(bed.state().reference_position, lists));
  }
}
BENCHMARK(EnterAll)->Arg(256)->Arg(10000)->Arg(100000)->Unit(benchmark::kMicrosecond);

/// Times the contact of the shovel at the centre of the bed of icra2021.
void ToolContact(benchmark::State& state) {
  Bed bed(bedOf(256));
  const Pose pose{Vec3(0, 0, 0.025), Quat::Identity()};
  ToolMemory memory(bed);
  for (auto _ : state) {
    benchmark::DoNotOptimize(applyToolContact(ToolParameters{}, pose, Twist{}, bed.parameters().soil, 1e-3, bed.state(),
                                              memory.particles(), bed.externalForces()));
  }
}
BENCHMARK(ToolContact)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace haptolith

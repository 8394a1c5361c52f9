// A host that owns the device and the loop, as CHAI3D and robot controllers do. haptolith computes the soil's force and makes
// it safe to render. The loop does not allocate.
#include <cmath>
#include <cstdio>
#include <haptolith/haptolith.hpp>

int main() try {
  hapto::Scene scene = hapto::Scene::fromFile("icra2021");
  const double surface_m = scene.info().surface_m;

  auto limits = hapto::sized<hapto_device_limits>();
  hapto::require(hapto_device_limits_init(&limits));
  limits.max_force_n = 3;
  hapto::Safety safety(limits, 1e-3, 100, {"safety.soft_start_s=0.5"});

  auto told = hapto::sized<hapto_device_input>();
  told.pose = {{0, 0, surface_m + 0.02}, {1, 0, 0, 0}};
  scene.placeTool(told.pose);
  double strongest_n = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    // The device reports the handle's pose; this one moves into the soil and out of it.
    const double phase = 2 * 3.14159265358979 * tick / 3000;
    told.pose.position_m[2] = surface_m + 0.02 * std::cos(phase) - 0.015 * (1 - std::cos(phase));
    if (tick == 2000) {
      told.pose.position_m[2] = NAN;  // a loose cable
      const hapto_wrench shown = safety.step(told, scene.wrench());
      std::printf("2.000 s  the handle is nowhere: %.3f N, \"%s\"\n", shown.force_n[2], safety.info().trip);
      continue;
    }
    const hapto_wrench soil = scene.step(told.pose);
    const hapto_wrench shown = safety.step(told, soil);  // to your device
    strongest_n = std::fmax(strongest_n, shown.force_n[2]);
  }
  std::printf("strongest force shown: %.3f N; %u trip(s)\n", strongest_n, safety.info().trips);
  return 0;
} catch (const hapto::Error &error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

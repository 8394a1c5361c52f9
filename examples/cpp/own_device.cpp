// A custom haptic device in haptolith's loop. Here it is simulated: a handle of 0.3 kg on a spring that pulls it into the soil
// and along it. A real one reads its hardware instead.
#include <chrono>
#include <cstdio>
#include <haptolith/haptolith.hpp>
#include <thread>

class HandleOnASpring final : public hapto::Device {
 public:
  const char *name() const noexcept override { return "handle on a spring"; }

  void declare(hapto_device_limits &limits) const noexcept override {
    limits.simulated = 1;  // no person holds it
    limits.max_force_n = 12;
    limits.workspace_radius_m = 0.15;
    limits.turns = 0;
  }

  void read(hapto_device_input &told) noexcept override {
    const double wanted_m[3] = {0.03 * ticks_ * 1e-3, 0, -0.11};
    for (int axis = 0; axis < 3; ++axis) {
      const double pull_n = 60 * (wanted_m[axis] - position_m_[axis]) - 6 * velocity_m_s_[axis] + felt_n_[axis];
      velocity_m_s_[axis] += 1e-3 * pull_n / 0.3;
      position_m_[axis] += 1e-3 * velocity_m_s_[axis];
      told.pose.position_m[axis] = position_m_[axis];
      told.twist.linear_m_s[axis] = velocity_m_s_[axis];
    }
    ++ticks_;
  }

  void write(const hapto_device_output &force) noexcept override {
    for (int axis = 0; axis < 3; ++axis) {
      felt_n_[axis] = force.wrench.force_n[axis];
    }
  }

 private:
  double position_m_[3] = {0, 0, 0}, velocity_m_s_[3] = {0, 0, 0}, felt_n_[3] = {0, 0, 0};
  int ticks_ = 0;
};

int main() try {
  hapto::Scene scene = hapto::Scene::fromFile("icra2021", {"loop.duration_s=2"});
  HandleOnASpring device;
  hapto::Loop loop(scene, device);
  loop.start();  // paced by the clock, on a separate thread
  for (hapto_snapshot now = loop.snapshot(); now.running != 0; now = loop.snapshot()) {
    std::printf("%4.1f s  tool at %5.1f mm  %6.3f N  tick %5.1f us\n", now.time_s, now.scene_T_tool.position_m[2] * 1e3,
                now.device_wrench.force_n[2], now.tick_us_p50);
    std::this_thread::sleep_for(std::chrono::milliseconds(250));
  }
  std::printf("ended: %s\n", loop.snapshot().end);
  return 0;
} catch (const hapto::Error &error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

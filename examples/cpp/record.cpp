// Records a hand that digs for 2 s, and replays the recording: record FILE.h5
#include <cmath>
#include <cstdio>
#include <exception>
#include <haptolith/recording.hpp>

namespace {

/// Presses into the soil and moves out of it at 2 Hz.
class Hand : public hapto::Device {
 public:
  void declare(hapto_device_limits &limits) const noexcept override { limits.simulated = 1; }
  void read(hapto_device_input &told) noexcept override {
    const double t = 1e-3 * ticks_++;
    told.pose.position_m[2] = -0.02 - 0.015 * std::sin(2 * 3.14159265358979 * 2 * t);
  }
  void write(const hapto_device_output &) noexcept override {}
  const char *name() const noexcept override { return "a hand that digs"; }

 private:
  int ticks_ = 0;
};

}  // namespace

int main(int argc, char **argv) try {
  const char *file = argc > 1 ? argv[1] : "run.h5";
  Hand hand;
  {
    hapto::Scene scene = hapto::Scene::fromFile("icra2021", {"mapping.offset_mm=[0, 0, 15]"});
    hapto::Loop loop(scene, hand, hapto::Loop::Ticked::kByCaller, hapto::Loop::Ticks::kKept);
    hapto::Recorder recorder(loop, file);
    for (int tick = 0; tick < 2000; ++tick) {
      loop.tick();
      if (tick % 100 == 99) {
        recorder.take();  // a host with a loop in real time calls this from another thread
      }
    }
    recorder.finish();
  }
  hapto::Recording recording(file);
  const auto replay = recording.verify();
  std::printf("%llu ticks, run again: %s\n", static_cast<unsigned long long>(recording.info().ticks),
              replay.same == 1 ? "the same to the last bit" : replay.different);
  double strongest_n = 0;
  for (const hapto_tick &tick : recording.ticks(0, 2000)) {
    strongest_n = std::fmax(strongest_n, tick.device_wrench.force_n[2]);
  }
  std::printf("the hand felt %.1f N at most\n", strongest_n);
  return replay.same == 1 && strongest_n > 0.1 ? 0 : 1;
} catch (const std::exception &error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

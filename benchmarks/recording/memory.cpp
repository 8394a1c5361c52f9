// Checks that the memory of a recording does not grow. Writes hours of a run as fast as the disk allows, in the batches
// of a run in real time, and prints the memory of the process. Exit status 1 if it grows by more than 0.5 MiB after the
// first two minutes.
//
//     build/release/benchmarks/haptolith_recording_memory FILE.h5 [HOURS [PARTICLES]]

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include "haptolith/recording/recording_file.h"

namespace haptolith {
namespace {

constexpr std::uint64_t kTicksPerS = 1000;
constexpr std::uint64_t kTicksAtOnce = 25;     // polling period of the writer's thread
constexpr std::uint64_t kTicksPerFrame = 100;  // 10 frames of the particles per second
constexpr std::uint64_t kFirst_s = 120;        // one-time allocations are complete by then
constexpr double kMostGrowth_kib = 512;

double residentKib() {
  std::ifstream file("/proc/self/statm");
  double pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1024;
}

double heapKib() {
  return static_cast<double>(mallinfo2().uordblks) / 1024;
}

/// Returns the record of a movement with incompressible low bits of the forces.
TickRecord tickNumber(std::uint64_t n) {
  TickRecord tick;
  tick.time_s = static_cast<double>(n) / kTicksPerS;
  tick.device.pose.position_m = Vec3(std::sin(tick.time_s), std::cos(1.3 * tick.time_s), std::sin(0.7 * tick.time_s));
  tick.scene_T_tool = tick.device.pose;
  tick.sent.wrench.force_n = 10 * tick.device.pose.position_m;
  tick.state_hash = n * 0x9E37'79B9'7F4A'7C15;
  return tick;
}

int measure(const std::string& path, double hours, std::size_t particles) {
  const auto ticks = static_cast<std::uint64_t>(hours * 3600 * kTicksPerS);
  hdf5::RecordingFile file(path, RecordingHeader{}, true, false);
  std::vector<TickRecord> fresh(kTicksAtOnce);
  double first_resident_kib = 0, most_growth_kib = 0;
  fmt::print("recorded / s   resident / KiB   heap in use / KiB   file / MiB\n");
  for (std::uint64_t n = 0; n < ticks; n += kTicksAtOnce) {
    for (std::uint64_t i = 0; i < kTicksAtOnce; ++i) {
      fresh[i] = tickNumber(n + i);
    }
    std::vector<ParticleFrame> frames;
    if (n % kTicksPerFrame == 0) {
      frames.push_back({.time_s = fresh.front().time_s, .tick = n, .position_m = {}});
      frames.back().position_m.resize(particles);
    }
    file.take({.ticks = fresh, .frames = frames});
    (void)file.writeWholeChunks();
    const std::uint64_t s = (n + kTicksAtOnce) / kTicksPerS;
    if ((n + kTicksAtOnce) % kTicksPerS != 0 || s < kFirst_s) {
      continue;
    }
    const double resident_kib = residentKib();
    first_resident_kib = s == kFirst_s ? resident_kib : first_resident_kib;
    most_growth_kib = std::max(most_growth_kib, resident_kib - first_resident_kib);
    if (s == kFirst_s || s % 600 == 0) {
      fmt::print("{:12}   {:14.0f}   {:17.0f}   {:10.1f}\n", s, resident_kib, heapKib(),
                 static_cast<double>(file.bytes()) / (1 << 20));
      std::fflush(stdout);
    }
  }
  file.close();
  fmt::print("grown by at most {:.0f} KiB after {} s\n", most_growth_kib, kFirst_s);
  return most_growth_kib <= kMostGrowth_kib ? 0 : 1;
}

}  // namespace
}  // namespace haptolith

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 4) {
    std::fputs("usage: haptolith_recording_memory FILE.h5 [HOURS [PARTICLES]]\n", stderr);
    return 2;
  }
  return haptolith::measure(argv[1], argc > 2 ? std::stod(argv[2]) : 2, argc > 3 ? std::stoul(argv[3]) : 256);
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}

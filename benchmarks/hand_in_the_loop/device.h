#pragma once

#include <cstdint>
#include <deque>
#include <random>

#include "packets.h"
#include "vec.h"

namespace hand_in_the_loop {

/// Location of the device's delay.
enum class DelayAt { kSplit, kShow, kMeasure };

struct DeviceParameters {
  double delay_ms = 0;
  DelayAt delay_at = DelayAt::kSplit;  ///< half at measuring and half at showing, or all at one of them
  double jitter_ms = 0;                ///< maximum additional delay of an answer; the order is kept
  double step_mm = 0;                  ///< resolution of positions
  double noise_mm = 0;                 ///< uniform noise between -noise and +noise, on each axis
  double force_step_n = 0;             ///< resolution of forces
  double drop = 0;                     ///< fraction of packets and of answers that are lost
  /// Smoothing of the velocity from quantised positions: v += share ((x - x_before) / 1 ms - v). 1: no smoothing.
  double velocity_share = 0.3;
  /// Time without an answer after which the device sets the force to zero (docs/reference/udp.md). 0: never.
  double blank_ms = 20;
};

struct Reading {
  Vec3 position_m, velocity_m_s;
};

/// Simulated device between handle and program: delayed, quantised measurements and delayed forces. Times are since the
/// begin of the run, in ns.
class Device {
 public:
  Device(const DeviceParameters& parameters, std::uint32_t seed);

  /// Receives an answer.
  void take(const Answer& answer, std::int64_t at_ns);
  /// Returns the rendered force at a time, N; times must not decrease.
  [[nodiscard]] Vec3 shown(std::int64_t at_ns);
  /// Adds a position of the handle; times must increase.
  void follow(std::int64_t at_ns, const Vec3& position_m);
  /// Returns the device's reading at a time; to be called at 1 kHz.
  [[nodiscard]] Reading read(std::int64_t at_ns);
  [[nodiscard]] bool drops() { return uniform_(random_) < parameters_.drop; }

 private:
  struct Shown {
    std::int64_t from_ns, arrived_ns;
    Vec3 force_n;
  };
  struct Place {
    std::int64_t at_ns;
    Vec3 position_m;
  };

  DeviceParameters parameters_;
  std::mt19937 random_;
  std::uniform_real_distribution<double> uniform_{0, 1};
  std::int64_t measure_ns_ = 0, show_ns_ = 0;
  std::deque<Shown> coming_;
  Shown now_{0, 0, {}};
  std::deque<Place> path_;
  Reading told_;
  bool told_once_ = false;
};

}  // namespace hand_in_the_loop

#pragma once

#include <cstdint>
#include <deque>
#include <random>

#include "packets.h"
#include "vec.h"

namespace hand_in_the_loop {

/// Where the device's delay comes from.
enum class DelayAt { kSplit, kShow, kMeasure };

struct DeviceParameters {
  double delay_ms = 0;
  DelayAt delay_at = DelayAt::kSplit;  ///< half at measuring and half at showing, or all at one of them
  double jitter_ms = 0;                ///< each answer is shown up to so much later; none overtakes another
  double step_mm = 0;                  ///< positions are told in steps of this
  double noise_mm = 0;                 ///< evenly spread between -noise and +noise, on each axis
  double force_step_n = 0;             ///< forces are shown in steps of this
  double drop = 0;                     ///< share of the packets that get lost, and of the answers
  /// A device tells the velocity of its steps, smoothed: v += share ((x - x_before) / 1 ms - v). 1: as it is.
  double velocity_share = 0.3;
  /// Without an answer for so long the device shows nothing, as docs/reference/udp.md asks for. 0: for ever.
  double blank_ms = 20;
};

struct Reading {
  Vec3 position_m, velocity_m_s;
};

/// What lies between the handle and the program: measures late and coarsely, shows late. Times are of the run, in ns.
class Device {
 public:
  Device(const DeviceParameters& parameters, std::uint32_t seed);

  /// An answer has come.
  void take(const Answer& answer, std::int64_t at_ns);
  /// The force that is shown at that time, N; times must not fall.
  [[nodiscard]] Vec3 shown(std::int64_t at_ns);
  /// The handle was there; times must rise.
  void follow(std::int64_t at_ns, const Vec3& position_m);
  /// What the device tells at that time; once a millisecond.
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

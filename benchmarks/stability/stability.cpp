#include "stability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "haptolith/haptics/wrench_filter.h"

namespace haptolith {

namespace {

constexpr double kTick_s = 1e-3;
constexpr std::size_t kTicks = 6900;
constexpr std::size_t kBegins = 400, kStirs = 1900, kStops = 3900, kOpens = 4400, kStill = 4900,
                      kWindow = 1000;  // first ticks

constexpr double kAbove_m = 0.02, kDepth_m = 0.015, kAtSoil_m = -0.001;
constexpr double kForceStep_n = 0.01;

Vec3 inSteps(const Vec3& value, double step) {
  return step == 0 ? value : Vec3((value / step).array().round() * step);
}

/// Device in a simulated hand, which the program treats as a person's. It advances by 1 ms with each write(), in ten
/// substeps.
class HeldDevice final : public HapticDevice {
 public:
  HeldDevice(const StabilityCase& parameters, double surface_m)
      : case_(parameters),
        hand_(parameters.hand),
        opens_((parameters.hand.opens == Opens::kAtSoil)      ? kStirs
               : (parameters.hand.opens == Opens::kWhenStill) ? kOpens
                                                              : kTicks),
        above_m_(0, 0, surface_m + kAbove_m),
        position_m_(above_m_),
        told_m_(inSteps(above_m_, parameters.step_m)),
        quick_(kTick_s) {
    if (parameters.hand.opens != Opens::kNever) {
      hand_.weight_n = 0;  // the hand carries the weight
    }
  }

  [[nodiscard]] std::string_view name() const noexcept override { return "device in a simulated hand"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    DeviceLimits limits;
    limits.max_force_n = 12;
    limits.max_torque_nm = 0.2;
    limits.max_force_rate_n_s = 4000;
    limits.max_torque_rate_nm_s = 67;
    limits.damping_n_s_m = case_.damping_n_s_m;
    limits.resolution_m = case_.resolution_m;
    limits.delay_known = case_.declared_ticks < 0;
    limits.delay_s = (case_.declared_ticks < 0 ? case_.delay_ticks : case_.declared_ticks) * kTick_s;
    return limits;
  }

  [[nodiscard]] DeviceInput read() noexcept override {
    const Vec3 noise_m = case_.noise_m * Vec3(uniform(), uniform(), uniform());
    const Vec3 now_m = inSteps(position_m_ + noise_m, case_.step_m);
    told_m_s_ += 0.3 * ((now_m - told_m_) / kTick_s - told_m_s_);  // smoothing of encoder steps, as in drivers
    told_m_ = now_m;
    DeviceInput input;
    input.pose.position_m = now_m;
    input.twist.linear_m_s = told_m_s_;
    return input;
  }

  void write(const DeviceOutput& output) noexcept override {
    sent_n_[ticks_ % sent_n_.size()] = inSteps(output.wrench.force_n, kForceStep_n);
    const std::size_t delay = static_cast<std::size_t>(case_.delay_ticks);
    const Vec3 force_n = ticks_ < delay ? Vec3::Zero() : sent_n_[(ticks_ - delay) % sent_n_.size()];
    if (ticks_ == opens_) {
      hand_ = {.weight_n = case_.hand.weight_n};
      released_j_ = given_j_;
      result.released_n = force_n.norm();
    }
    const Vec3 from_m = position_m_;
    move(force_n);
    account(force_n.dot(position_m_ - from_m), (position_m_ - from_m) / kTick_s);
    ++ticks_;
  }

  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}

  StabilityResult result;

 private:
  /// Returns a random number from -1 to 1, reproducible.
  [[nodiscard]] double uniform() noexcept {
    random_ ^= random_ << 13U;
    random_ ^= random_ >> 7U;
    random_ ^= random_ << 17U;
    return 2 * (static_cast<double>(random_ >> 11U) * 0x1p-53) - 1;
  }

  /// Returns the hand's target for the handle.
  [[nodiscard]] Vec3 wanted() const {
    const double time_s = static_cast<double>(ticks_) * kTick_s;
    const double depth_m = case_.hand.opens == Opens::kAtSoil ? kAtSoil_m : kDepth_m;
    Vec3 there = above_m_ - Vec3(0, 0, (kAbove_m + depth_m) * std::clamp(time_s - 1e-3 * kBegins, 0.0, 1.0));
    if (ticks_ >= kStirs && ticks_ < kStops) {
      there.x() = 0.02 * std::sin(std::numbers::pi * (time_s - 1e-3 * kStirs));
    }
    return there;
  }

  void move(const Vec3& force_n) {
    constexpr int kSteps = 10;
    if (ticks_ < kBegins) {  // the handle is held until the tool is in the loop
      return;
    }
    const double mass_kg = case_.handle_kg + hand_.mass_kg;
    const double damping_n_s_m = hand_.damping_n_s_m + case_.damping_n_s_m;
    const Vec3 wanted_m = wanted();
    for (int step = 0; step < kSteps; ++step) {
      const Vec3 sum_n = hand_.stiffness_n_m * (wanted_m - position_m_) - damping_n_s_m * velocity_m_s_ + force_n -
                         Vec3(0, 0, hand_.weight_n);
      velocity_m_s_ += kTick_s / kSteps / mass_kg * sum_n;
      position_m_ += kTick_s / kSteps * velocity_m_s_;
    }
  }

  void account(double given_j, const Vec3& velocity_m_s) {
    given_j_ += given_j;
    result.injected_j = std::max(result.injected_j, given_j_);
    if (ticks_ >= opens_) {
      result.after_release_j = std::max(result.after_release_j, given_j_ - released_j_);
    }
    const Vec3 quick_m_s = quick_.step(velocity_m_s);
    if (ticks_ < kStill) {
      lowest_j_ = given_j_;
      return;
    }
    if (ticks_ == kStill + kWindow) {
      result.vibration_before_m = (highest_m_ - lowest_m_).maxCoeff();
      lowest_m_ = highest_m_ = quick_m_;
    }
    lowest_j_ = std::min(lowest_j_, given_j_);
    result.returned_j = std::max(result.returned_j, given_j_ - lowest_j_);
    quick_m_ += kTick_s * quick_m_s;
    lowest_m_ = lowest_m_.cwiseMin(quick_m_);
    highest_m_ = highest_m_.cwiseMax(quick_m_);
    result.vibration_m = (highest_m_ - lowest_m_).maxCoeff();
  }

  StabilityCase case_;
  HoldingHand hand_;
  std::size_t opens_;  ///< tick at which the hand opens
  Vec3 above_m_, position_m_, velocity_m_s_ = Vec3::Zero();
  Vec3 told_m_, told_m_s_ = Vec3::Zero();
  std::array<Vec3, 32> sent_n_;  ///< ring buffer of the last ticks
  std::size_t ticks_ = 0;
  double given_j_ = 0, lowest_j_ = 0, released_j_ = 0;
  std::uint64_t random_ = 0x9E3779B97F4A7C15U;
  QuickMovement quick_;
  Vec3 quick_m_ = Vec3::Zero(), lowest_m_ = Vec3::Zero(), highest_m_ = Vec3::Zero();
};

}  // namespace

LyingSoil settled(const BedParameters& bed) {
  return Bed(bed).lying();
}

StabilityResult measureStability(const BedParameters& bed, const LyingSoil& lying, const StabilityCase& parameters,
                                 const ToolParameters& tool) {
  Scene scene(bed, tool, lying);
  HeldDevice device(parameters, scene.bed().surfaceHeight());
  LoopParameters loop_parameters;
  loop_parameters.real_time = false;
  HandlingParameters handling;
  handling.coupling.kind = parameters.coupling;
  handling.coupling.spring = parameters.spring;
  handling.safety.passivity = parameters.passivity;
  handling.safety.soft_start_s = 0;  // would only hide the effect
  HapticLoop loop(scene, device, loop_parameters, true, handling);
  std::vector<TickRecord> records;
  std::size_t damped = 0;
  std::vector<Vec3> last_n;
  for (std::size_t tick = 0; tick < kTicks && device.result.end == LoopEnd::kRunning; ++tick) {
    device.result.end = loop.tick();
    records.clear();
    loop.takeRecords(records);
    if (!records.empty() && records.back().rendered.wrench.force_n.norm() > 0.5) {
      device.result.softest = std::min(device.result.softest, records.back().sent.wrench.force_n.norm() /
                                                                  records.back().rendered.wrench.force_n.norm());
    }
    if (tick >= kTicks - 1000 && !records.empty()) {
      last_n.push_back(records.back().sent.wrench.force_n);
    }
    damped += static_cast<std::size_t>(
        std::ranges::count_if(records, [](const TickRecord& r) { return (r.flags & kTickPassivityDamped) != 0; }));
  }
  device.result.damped_share = static_cast<double>(damped) / kTicks;
  if (!last_n.empty()) {
    Vec3 sum_n = Vec3::Zero();
    double squares = 0;
    for (const Vec3& force_n : last_n) {
      sum_n += force_n;
      squares += force_n.squaredNorm();
    }
    const double count = static_cast<double>(last_n.size());
    device.result.held_n = (sum_n / count).norm();
    device.result.felt_sd_n = std::sqrt(std::max(0.0, squares / count - device.result.held_n * device.result.held_n));
  }
  return device.result;
}

}  // namespace haptolith

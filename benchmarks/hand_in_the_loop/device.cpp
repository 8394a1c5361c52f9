#include "device.h"

namespace hand_in_the_loop {

namespace {

std::int64_t nanoseconds(double ms) {
  return std::llround(1e6 * ms);
}

}  // namespace

Device::Device(const DeviceParameters& parameters, std::uint32_t seed) : parameters_(parameters), random_(seed) {
  const double at_measuring = parameters.delay_at == DelayAt::kMeasure ? 1
                              : parameters.delay_at == DelayAt::kSplit ? 0.5
                                                                       : 0;
  measure_ns_ = nanoseconds(at_measuring * parameters.delay_ms);
  show_ns_ = nanoseconds(parameters.delay_ms) - measure_ns_;
}

void Device::take(const Answer& answer, std::int64_t at_ns) {
  const std::int64_t due_ns = at_ns + show_ns_ + nanoseconds(parameters_.jitter_ms * uniform_(random_));
  const std::int64_t before_ns = coming_.empty() ? now_.from_ns : coming_.back().from_ns;
  coming_.push_back({std::max(due_ns, before_ns), at_ns, inSteps(answer.force_n, parameters_.force_step_n)});
}

Vec3 Device::shown(std::int64_t at_ns) {
  while (!coming_.empty() && coming_.front().from_ns <= at_ns) {
    now_ = coming_.front();
    coming_.pop_front();
  }
  const bool silent = parameters_.blank_ms > 0 && at_ns - now_.from_ns > nanoseconds(parameters_.blank_ms);
  return silent ? Vec3{} : now_.force_n;
}

void Device::follow(std::int64_t at_ns, const Vec3& position_m) {
  path_.push_back({at_ns, position_m});
}

Reading Device::read(std::int64_t at_ns) {
  while (path_.size() > 1 && path_[1].at_ns <= at_ns - measure_ns_) {
    path_.pop_front();
  }
  Vec3 position_m = path_.front().position_m;
  if (const double noise_m = 1e-3 * parameters_.noise_mm; noise_m > 0) {
    std::uniform_real_distribution<double> noise(-noise_m, noise_m);
    position_m += {noise(random_), noise(random_), noise(random_)};
  }
  position_m = inSteps(position_m, 1e-3 * parameters_.step_mm);
  constexpr double kPeriod_s = 1e-3;
  if (told_once_) {
    told_.velocity_m_s +=
        parameters_.velocity_share * (1 / kPeriod_s * (position_m - told_.position_m) - told_.velocity_m_s);
  }
  told_.position_m = position_m;
  told_once_ = true;
  return told_;
}

}  // namespace hand_in_the_loop

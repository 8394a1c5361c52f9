#include "haptolith/teleop/link/link.h"

#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace haptolith {

namespace {

constexpr double kBitsPerByte = 8;
constexpr std::size_t kBytesBeside = 100;  // a packet's own

/// Pareto's distribution of index 3, from a standard normal deviate of the same rank; shifted
/// and scaled to mean 0 and standard deviation 1.
double paretoDeviate(double normal) noexcept {
  constexpr double kIndex = 3;
  const double mean = kIndex / (kIndex - 1);
  const double deviation = std::sqrt(kIndex / (kIndex - 2)) / (kIndex - 1);
  const double beyond = 0.5 * std::erfc(normal / std::sqrt(2));  // share of packets that take longer
  return (std::pow(std::max(beyond, 1e-12), -1 / kIndex) - mean) / deviation;
}

}  // namespace

Link::Link(const LinkParameters& parameters) : parameters_(parameters), random_(parameters.seed) {
  validate(parameters_);
}

void Link::send(double time_s, Packet packet) {
  now_s_ = std::max(now_s_, time_s);
  ++counts_.sent;
  ++number_;
  // Random numbers are drawn first, for every packet: neither an outage nor the rate changes later
  // draws.
  const bool lost = isLost();
  const bool twice = happens(parameters_.duplicate);
  const double jitter_s = jitter();
  const double again_jitter_s = parameters_.duplicate > 0 ? jitter() : 0;

  double leaves_s = now_s_;
  if (parameters_.rate_bit_s > 0) {
    while (!queued_until_s_.empty() && queued_until_s_.front() <= now_s_) {
      queued_until_s_.pop_front();
    }
    if (queued_until_s_.size() >= static_cast<std::size_t>(parameters_.queue_packets)) {
      ++counts_.dropped;
      return;
    }
    const auto bytes = static_cast<double>(packet.size() + static_cast<std::size_t>(parameters_.overhead_bytes));
    leaves_s = std::max(now_s_, busy_until_s_) + kBitsPerByte * bytes / parameters_.rate_bit_s;
    busy_until_s_ = leaves_s;
    queued_until_s_.push_back(leaves_s);
  }
  if (isCutOff(leaves_s)) {
    ++counts_.cut_off;
    return;
  }
  if (lost) {
    ++counts_.lost;
    return;
  }
  if (twice) {
    ++counts_.duplicated;
    dispatch(leaves_s, again_jitter_s, packet);
  }
  dispatch(leaves_s, jitter_s, std::move(packet));
}

void Link::dispatch(double time_s, double jitter_s, Packet packet) {
  double arrives_s = std::max(time_s, time_s + delayAt(time_s) + jitter_s);
  if (parameters_.in_order) {
    arrives_s = last_arrival_s_ = std::max(arrives_s, last_arrival_s_);
  }
  bytes_on_the_way_ += packet.size() + kBytesBeside;
  on_its_way_.push_back({arrives_s, number_, std::move(packet)});
  std::ranges::push_heap(on_its_way_, arrivesLater);
}

std::optional<Link::Arrival> Link::receive(double time_s) {
  if (on_its_way_.empty() || on_its_way_.front().arrives_s > time_s) {
    return std::nullopt;
  }
  std::ranges::pop_heap(on_its_way_, arrivesLater);
  OnItsWay next = std::move(on_its_way_.back());
  on_its_way_.pop_back();
  bytes_on_the_way_ -= next.packet.size() + kBytesBeside;
  ++counts_.arrived;
  counts_.overtaken += next.number < newest_arrived_ ? 1 : 0;
  newest_arrived_ = std::max(newest_arrived_, next.number);
  return Arrival{next.arrives_s, std::move(next.packet)};
}

std::optional<double> Link::nextArrival() const noexcept {
  return on_its_way_.empty() ? std::nullopt : std::optional(on_its_way_.front().arrives_s);
}

bool Link::arrivesLater(const OnItsWay& one, const OnItsWay& other) noexcept {
  return std::pair(one.arrives_s, one.number) > std::pair(other.arrives_s, other.number);
}

/// From 0 to below 1.
double Link::uniform() noexcept {
  return static_cast<double>(random_() >> 11) * 0x1p-53;
}

double Link::normal() noexcept {
  return boost::math::quantile(boost::math::normal(), std::max(uniform(), 0x1p-54));  // the quantile of 0 is infinite
}

bool Link::isCutOff(double time_s) const noexcept {
  return std::ranges::any_of(parameters_.outages, [time_s](const Outage& outage) {
    return time_s >= outage.start_s && time_s < outage.start_s + outage.duration_s;
  });
}

bool Link::isLost() noexcept {
  if (parameters_.turns_bad > 0) {
    bad_ = bad_ ? !happens(parameters_.turns_good) : happens(parameters_.turns_bad);
  }
  const bool in_burst = bad_ && happens(parameters_.loss_while_bad);
  return happens(parameters_.loss) || in_burst;
}

double Link::delayAt(double time_s) const noexcept {
  const std::vector<DelayAt>& delays = parameters_.delays;
  if (delays.empty()) {
    return parameters_.delay_s;
  }
  const auto after = std::ranges::upper_bound(delays, time_s, {}, &DelayAt::time_s);
  return after == delays.begin() ? after->delay_s : std::prev(after)->delay_s;
}

double Link::jitter() noexcept {
  if (parameters_.jitter_s == 0) {
    return 0;
  }
  const double rho = has_deviate_ ? parameters_.jitter_correlation : 0;
  has_deviate_ = true;
  deviate_ = rho * deviate_ + std::sqrt(1 - rho * rho) * normal();
  switch (parameters_.jitter_shape) {
    case JitterShape::kNormal: return parameters_.jitter_s * deviate_;
    case JitterShape::kUniform: return parameters_.jitter_s * std::erf(deviate_ / std::sqrt(2));
    case JitterShape::kPareto: return parameters_.jitter_s * paretoDeviate(deviate_);
  }
  return 0;
}

}  // namespace haptolith

#pragma once

#include <algorithm>

namespace haptolith {

/// A share, 0 to 1, that grows and falls evenly. May be used in the tick.
class Ramp {
 public:
  explicit Ramp(double share) : share_(share) {}

  void set(double share) noexcept { share_ = share; }
  /// One tick of `tick_s` on the way up, or down, of which all takes `whole_s`.
  void rise(double tick_s, double whole_s) noexcept { share_ = std::min(1.0, share_ + tick_s / whole_s); }
  void fall(double tick_s, double whole_s) noexcept { share_ = std::max(0.0, share_ - tick_s / whole_s); }

  [[nodiscard]] double share() const noexcept { return share_; }

 private:
  double share_;
};

}  // namespace haptolith

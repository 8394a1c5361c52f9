#pragma once

#include <cstdint>
#include <optional>

namespace haptolith {

/// What a device's buttons say. Button 0, which a squeezed gripper is too, goes on; at a question it answers left when
/// pressed briefly and right when held for 0.6 s. Button 1 answers right at once. What is down already when something
/// is asked does not count.
class ButtonAnswer {
 public:
  static constexpr double kLong_s = 0.6;

  /// Something is asked from now on.
  void ask() noexcept { armed_ = false; }

  /// @return 0 or 1 once for each press that is complete.
  std::optional<int> step(std::uint32_t buttons, double now_s) noexcept {
    const bool first = (buttons & 1U) != 0;
    const bool second = (buttons & 2U) != 0;
    if (!armed_) {
      armed_ = !first && !second;
      pressed_at_s_.reset();
      return std::nullopt;
    }
    if (second) {
      armed_ = false;
      return 1;
    }
    if (first) {
      pressed_at_s_ = pressed_at_s_.value_or(now_s);
      if (now_s - *pressed_at_s_ >= kLong_s) {
        armed_ = false;
        return 1;
      }
      return std::nullopt;
    }
    if (pressed_at_s_) {
      pressed_at_s_.reset();
      return 0;
    }
    return std::nullopt;
  }

 private:
  bool armed_ = false;
  std::optional<double> pressed_at_s_;
};

}  // namespace haptolith

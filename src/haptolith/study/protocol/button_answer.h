#pragma once

#include <cstdint>
#include <optional>

namespace haptolith {

/// Interprets a device's buttons as responses. Button 0, or a squeezed gripper, continues; at a question a short press
/// responds left, and a press of 0.6 s responds right. Button 1 responds right immediately. A button that is already
/// down when the question appears is ignored.
class ButtonAnswer {
 public:
  static constexpr double kLong_s = 0.6;

  /// Begins a question.
  void ask() noexcept { armed_ = false; }

  /// @return 0 or 1, once for each complete press.
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

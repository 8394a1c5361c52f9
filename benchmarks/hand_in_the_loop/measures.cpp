#include "measures.h"

#include <cmath>
#include <numbers>

namespace hand_in_the_loop {

namespace {

constexpr double kPeriod_s = 1e-3;
constexpr double kLast_s = 2;  // duration of the end of a run

double peakToPeak(const std::vector<double>& x, std::size_t from, std::size_t to) {
  if (from >= to) {
    return 0;
  }
  const auto [low, high] =
      std::minmax_element(x.begin() + static_cast<std::ptrdiff_t>(from), x.begin() + static_cast<std::ptrdiff_t>(to));
  return *high - *low;
}

/// Returns the frequency from the number of sign changes.
double frequency(const std::vector<double>& x) {
  int changes = 0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    changes += (x[i] > 0) != (x[i - 1] > 0) ? 1 : 0;
  }
  return x.empty() ? 0 : changes / 2.0 / (kPeriod_s * static_cast<double>(x.size()));
}

}  // namespace

HighPass::HighPass(double cutoff_hz) {
  const double w = std::tan(std::numbers::pi * cutoff_hz * kPeriod_s);
  const double norm = 1 / (1 + std::numbers::sqrt2 * w + w * w);
  b0_ = norm;
  a1_ = 2 * (w * w - 1) * norm;
  a2_ = (1 - std::numbers::sqrt2 * w + w * w) * norm;
}

double HighPass::step(double x) {
  if (!begun_) {
    x1_ = x2_ = x;  // as after a constant input
    begun_ = true;
  }
  const double y = b0_ * (x - 2 * x1_ + x2_) - a1_ * y1_ - a2_ * y2_;
  x2_ = x1_;
  x1_ = x;
  y2_ = y1_;
  y1_ = y;
  return y;
}

void Observer::answer(double at_s, Phase phase, const Answer& answer) {
  const double force_n = length(answer.force_n);
  Measures& m = measures_;
  ++m.answers;
  m.largest_force_n = std::max(m.largest_force_n, force_n);
  m.largest_torque_nm = std::max(m.largest_torque_nm, length(answer.torque_nm));
  const bool zero = answer.force_n == Vec3{} && answer.torque_nm == Vec3{};
  if (any_) {
    const std::uint32_t between = answer.number - last_.number;
    m.longest_gap_ms = phase > Phase::kWait ? std::max(m.longest_gap_ms, 1e3 * (at_s - last_s_)) : 0;
    if (between > 0 && between < 1U << 31U) {
      m.lost += between - 1;
      if (!zero) {
        m.largest_step_n_ms = std::max(m.largest_step_n_ms, length(answer.force_n - last_.force_n) / between);
      }
    }
  }

  // When the tool leaves soil, the force decreases gradually through the program's low-pass. A step from a perceptible
  // force to exactly zero is a safety trip.
  constexpr double kFelt_n = 0.05;
  const bool falls = zero && any_ && length(last_.force_n) > kFelt_n;
  const bool before = released_;
  released_ = phase > Phase::kWait && (answer.let_go || !answer.live || falls || (released_ && zero));
  if (released_ && !before) {
    releases_s_.push_back(at_s);
    m.first_let_go_s = m.first_let_go_s < 0 ? at_s : m.first_let_go_s;
  }
  if (phase > Phase::kPress) {
    ++in_soil_;
    released_in_soil_ += released_ ? 1 : 0;
  }

  if (phase == Phase::kPress || phase == Phase::kSettle) {
    press_.add(force_n);
    press_up_.add(answer.force_n.z);
  } else if (phase == Phase::kDraw) {
    draw_.add(force_n);
  } else if (phase == Phase::kStill && at_s >= end_s_ - kLast_s) {
    still_.add(force_n);
    still_up_.add(answer.force_n.z);
  }
  any_ = true;
  last_ = answer;
  last_s_ = at_s;
}

void Observer::handle(double at_s, const Vec3& position_m, double energy_j) {
  Measures& m = measures_;
  const double energy_mj = 1e3 * energy_j;
  lowest_mj_ = std::min(lowest_mj_, energy_mj);
  m.energy_rise_mj = std::max(m.energy_rise_mj, energy_mj - lowest_mj_);
  m.energy_max_mj = std::max(m.energy_max_mj, energy_mj);
  m.energy_end_mj = energy_mj;
  if (opened_at_mj_) {
    m.opened_mj = std::max(m.opened_mj, energy_mj - *opened_at_mj_);
  }
  if (energy_mj > bars_.energy_mj && m.first_excess_s < 0) {
    m.first_excess_s = at_s;
  }
  const double quick_mm[] = {1e3 * quick_[0].step(position_m.x), 1e3 * quick_[1].step(position_m.y),
                             1e3 * quick_[2].step(position_m.z)};
  if (at_s >= end_s_ - kLast_s) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      quick_mm_[axis].push_back(quick_mm[axis]);
    }
  }
}

void Observer::open(double shown_n, double energy_j) {
  measures_.opened_n = shown_n;
  opened_at_mj_ = 1e3 * energy_j;
}

Measures Observer::measures() const {
  Measures m = measures_;
  for (const std::vector<double>& x : quick_mm_) {
    const double all_mm = peakToPeak(x, 0, x.size());
    if (all_mm > m.vibration_mm) {
      m.vibration_mm = all_mm;
      m.vibration_hz = frequency(x);
    }
    m.vibration_before_mm = std::max(m.vibration_before_mm, peakToPeak(x, 0, x.size() / 2));
    m.vibration_after_mm = std::max(m.vibration_after_mm, peakToPeak(x, x.size() / 2, x.size()));
  }
  m.let_go_share = in_soil_ > 0 ? static_cast<double>(released_in_soil_) / static_cast<double>(in_soil_) : 0;
  m.press_n = press_.mean();
  m.draw_n = draw_.mean();
  m.still_n = still_.mean();
  m.press_up_n = press_up_.mean();
  m.still_up_n = still_up_.mean();
  m.still_sd_n = still_up_.sd();
  return m;
}

Verdict judge(const Measures& measures, const std::vector<double>& releases_s, const Bars& bars) {
  const bool energy = measures.energy_max_mj > bars.energy_mj;
  const bool shaking =
      measures.vibration_after_mm > bars.still_mm && measures.vibration_after_mm > 0.8 * measures.vibration_before_mm;
  if (!energy && !shaking) {
    return Verdict::kOk;
  }
  if (energy && !shaking) {
    // The energy during the delay after a safety trip may be the part that exceeds the bar.
    constexpr double kBefore_s = 0.05;
    for (const double at_s : releases_s) {
      if (at_s >= measures.first_excess_s - kBefore_s && at_s <= measures.first_excess_s + bars.let_go_s) {
        return Verdict::kReleased;
      }
    }
  }
  return energy && shaking ? Verdict::kBoth : energy ? Verdict::kEnergy : Verdict::kShaking;
}

const char* text(Verdict verdict) {
  switch (verdict) {
    case Verdict::kOk: return "ok";
    case Verdict::kReleased: return "let-go";
    case Verdict::kEnergy: return "ENERGY";
    case Verdict::kShaking: return "SHAKING";
    case Verdict::kBoth: return "ENERGY+SHAKING";
  }
  return "";
}

}  // namespace hand_in_the_loop

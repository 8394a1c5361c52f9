#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "packets.h"
#include "vec.h"

namespace hand_in_the_loop {

/// Limits for the verdict on a run.
struct Bars {
  double energy_mj = 5;   ///< maximum energy transferred to the hand
  double still_mm = 0.1;  ///< amplitude below which a vibration need not decay
  double let_go_s = 0.5;  ///< a safety trip within this time after the first excess is also accepted
};

/// Measures of a run. Energies are the work of the rendered force on the handle.
struct Measures {
  double largest_force_n = 0;    ///< maximum over all answers
  double largest_step_n_ms = 0;  ///< maximum between consecutive answers, except steps to zero
  double largest_torque_nm = 0;
  double energy_max_mj = 0;  ///< maximum of the sum since the start
  double energy_end_mj = 0;
  double energy_rise_mj = 0;   ///< maximum increase of the sum above an earlier value
  double opened_n = 0;         ///< rendered force when the hand opened
  double opened_mj = 0;        ///< maximum increase of the sum since the hand opened
  double first_excess_s = -1;  ///< time since the script's start when the sum first exceeded the bar; -1: never
  double vibration_mm = 0;     ///< peak to peak above 6 Hz, in the last 2 s
  double vibration_hz = 0;
  double vibration_before_mm = 0;  ///< in the first of the last two seconds
  double vibration_after_mm = 0;   ///< in the last second
  double first_let_go_s = -1;
  double let_go_share = 0;                      ///< fraction of tripped answers with the tool in the soil
  double press_n = 0, draw_n = 0, still_n = 0;  ///< mean magnitudes of the force; still: the last 2 s
  double press_up_n = 0, still_up_n = 0;        ///< means of the force's upward component
  double still_sd_n = 0;                        ///< SD of the force's upward component in the last 2 s
  double answers = 0, lost = 0;                 ///< lost: missing sequence numbers
  double longest_gap_ms = 0;                    ///< maximum time between two answers
};

/// Second-order Butterworth high-pass for samples at 1 kHz.
class HighPass {
 public:
  explicit HighPass(double cutoff_hz);
  [[nodiscard]] double step(double x);

 private:
  double b0_, a1_, a2_, x1_ = 0, x2_ = 0, y1_ = 0, y2_ = 0;
  bool begun_ = false;
};

enum class Phase { kWait, kPress, kSettle, kDraw, kStill, kOver };

/// Collects the events of a run, in the order of time; times are since the script's start and negative before it.
/// Safety trips and gaps count after the wait, because there is no force before.
class Observer {
 public:
  explicit Observer(const Bars& bars, double end_s) : bars_(bars), end_s_(end_s) {}

  void answer(double at_s, Phase phase, const Answer& answer);
  /// Adds the handle's state, at 1 kHz; energy is the work of the rendered force since the start.
  void handle(double at_s, const Vec3& position_m, double energy_j);
  /// Marks the opening of the hand, once.
  void open(double shown_n, double energy_j);
  [[nodiscard]] Measures measures() const;
  /// Whether the force is off: from a safety trip until it is on again.
  [[nodiscard]] bool isReleased() const { return released_; }
  /// Returns the times of all safety trips, since the script's start.
  [[nodiscard]] const std::vector<double>& releases() const { return releases_s_; }

 private:
  struct Mean {
    double sum = 0, squares = 0;
    long n = 0;
    void add(double x) { sum += x, squares += x * x, ++n; }
    [[nodiscard]] double mean() const { return n > 0 ? sum / n : 0; }
    [[nodiscard]] double sd() const { return n > 1 ? std::sqrt(std::max(0.0, squares / n - mean() * mean())) : 0; }
  };

  Bars bars_;
  double end_s_;
  Measures measures_;
  bool any_ = false, released_ = false;
  Answer last_;
  double last_s_ = 0;
  long in_soil_ = 0, released_in_soil_ = 0;
  Mean press_, draw_, still_, press_up_, still_up_;
  double lowest_mj_ = 0;
  std::optional<double> opened_at_mj_;
  std::vector<double> releases_s_;
  std::array<HighPass, 3> quick_ = {HighPass(6), HighPass(6), HighPass(6)};
  std::array<std::vector<double>, 3> quick_mm_;  ///< high-passed positions in the last 2 s
};

enum class Verdict { kOk, kReleased, kEnergy, kShaking, kBoth };

/// Judges a run. kOk: energy within the limit, and a vibration that is small or decays. kReleased: above the limits,
/// but tripped in time.
[[nodiscard]] Verdict judge(const Measures& measures, const std::vector<double>& releases_s, const Bars& bars);
[[nodiscard]] const char* text(Verdict verdict);

}  // namespace hand_in_the_loop

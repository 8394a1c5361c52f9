#include "haptolith/haptics/safety/passivity.h"

#include <algorithm>
#include <cmath>

#include "haptolith/core/assert.h"
#include "haptolith/core/movement.h"

namespace haptolith {

namespace {

/// The strongest damper, in N s/m: with an output that is 5 ms late it still damps whatever weighs more than 0.06 kg
/// (alpha < pi m / (2 T)).
constexpr double kStrongest_n_s_m = 20;

/// The quick account, docs/explanation/safety.md: it forgets within a period and a half of the slowest movement that it
/// sees (6 Hz); soil that slips under a hand rightly gives 2 mJ at once, and not again within 2 s. With more forgiven,
/// a hand that shakes keeps the difference each time; with less, the damper is felt in every slip.
constexpr double kForgetting_s = 0.25;
constexpr double kForgiven_j = 2e-3;
constexpr double kForgivenAgain_j = 0.2e-3;
constexpr double kForgiveness_s = 2;

/// Joins turning to moving: a handle's radius of gyration, about.
constexpr double kLever_m = 0.05;

/// Initial credit: energy that a delayed force may give to a hand that has done no work yet.
constexpr double kCredit_j = 0.5e-3;
constexpr double kLightestHandle_kg = 0.05;

/// Brakes a handle that jumps along a force of unknown delay; slower movements, and those that noise pretends, are not
/// braked. A damper this strong and 10 ms late shakes a handle of 0.1 kg (above pi m / (2 T) = 16 N s/m), so it weakens
/// as it brakes, and recovers slowly.
constexpr double kJumpDamper_n_s_m = 25;
constexpr double kJump_m_s = 0.01;
constexpr double kBraked_s = 0.03;
constexpr double kBrakedForgotten_s = 5;

/// Duration over which noise is measured, and width of the dead band in its standard deviations.
constexpr double kNoise_s = 0.5;
constexpr double kNoiseWidths = 2.5;

/// A step of position makes the damper show no more: well below what a hand feels.
constexpr double kUnfelt_n = 0.05;

/// Shaking: less than 0.3 mJ in a quarter of a second is what noise of +-0.1 mm and grains that slip make of a force
/// that is steady. A millijoule more halves the force; it is forgotten slowly, because a grip that shook once will
/// shake again. An impact of a dropped handle returns its energy within about 30 ms: at 5 mW it does not count as
/// shaking.
constexpr double kShakingAllowed_j = 0.3e-3;
constexpr double kShakingHalves_j = 1e-3;
constexpr double kShakingForgotten_s = 10;
constexpr double kShakingBooked_w = 5e-3;

double squaredSpeed(const Twist& twist) noexcept {
  return twist.linear_m_s.squaredNorm() + kLever_m * kLever_m * twist.angular_rad_s.squaredNorm();
}

double power(const Wrench& wrench, const Twist& twist) noexcept {
  return wrench.force_n.dot(twist.linear_m_s) + wrench.torque_nm.dot(twist.angular_rad_s);
}

/// The damper that takes `excess_j` out of this movement within a tick, or as much as it may.
Wrench damper(double excess_j, const Twist& twist, double strongest_n_s_m, double tick_s) noexcept {
  HAPTO_ASSERT(tick_s > 0);
  const double speed_squared = squaredSpeed(twist);
  if (excess_j <= 0 || speed_squared == 0) {
    return {};
  }
  const double alpha = std::min(excess_j / (tick_s * speed_squared), strongest_n_s_m);
  return {-alpha * twist.linear_m_s, -alpha * kLever_m * kLever_m * twist.angular_rad_s};
}

/// A dead band: by how much `moved_m` leaves it, axis by axis.
Vec3 beyond(double half_width_m, const Vec3& moved_m) noexcept {
  return half_width_m > 0 ? Vec3(moved_m - moved_m.cwiseMin(half_width_m).cwiseMax(-half_width_m)) : moved_m;
}

/// Returns the mean of the last three movements, axis by axis; zero where only one of the three is not zero, since a
/// slow device reports single steps.
Vec3 meanWithoutSingleSteps(const std::array<Vec3, 3>& moved_m) noexcept {
  Vec3 mean_m;
  for (int axis = 0; axis < 3; ++axis) {
    int moves = 0;
    double sum_m = 0;
    for (const Vec3& moved : moved_m) {
      moves += moved[axis] != 0 ? 1 : 0;
      sum_m += moved[axis];
    }
    mean_m[axis] = moves > 1 ? sum_m / 3 : 0;
  }
  return mean_m;
}

}  // namespace

Passivity::Passivity(const PassivityParameters& parameters, double tick_s) noexcept
    : parameters_(parameters),
      tick_s_(tick_s),
      strongest_damper_n_s_m_(parameters.resolution_m > 0
                                  ? std::min(kStrongest_n_s_m, kUnfelt_n * tick_s / parameters.resolution_m)
                                  : kStrongest_n_s_m),
      quick_velocity_(tick_s),
      quick_rotation_(tick_s),
      quick_jump_(tick_s),
      delay_(std::min(static_cast<std::size_t>(std::lround(parameters.delay_s / tick_s)), sent_.size() - 1)),
      accounts_{Account{0, QuickMovement(tick_s), QuickMovement(tick_s)},
                Account{0, QuickMovement(tick_s), QuickMovement(tick_s)},
                Account{0, QuickMovement(tick_s), QuickMovement(tick_s)},
                Account{0, QuickMovement(tick_s), QuickMovement(tick_s)},
                Account{0, QuickMovement(tick_s), QuickMovement(tick_s)},
                Account{0, QuickMovement(tick_s), QuickMovement(tick_s)}},
      account_count_(parameters.delay_known ? 1 : accounts_.size()),
      forgiven_j_(kForgiven_j) {
  for (std::size_t i = 0; i < account_count_; ++i) {
    accounts_[i].delay = account_count_ == 1 ? delay_ : delay_ * i / (account_count_ - 1);
  }
}

/// Noise shows in third differences, in which a movement of a hand all but vanishes: 5 mm at 10 Hz leave 1 um. Those of
/// white noise have twenty times its variance.
double Passivity::deadBand(const Vec3& position_m) noexcept {
  if (parameters_.resolution_m == 0) {
    return 0;  // readings are exact
  }
  if (told_ == told_m_.size()) {
    const Vec3 third_m = position_m - 3 * told_m_[2] + 3 * told_m_[1] - told_m_[0];
    noise_m2_ += (third_m.cwiseAbs2().maxCoeff() / 20 - noise_m2_) * tick_s_ / kNoise_s;
  }
  return std::max(parameters_.resolution_m, kNoiseWidths * std::sqrt(noise_m2_));
}

void Passivity::count(Account& account) noexcept {
  HAPTO_ASSERT(account.delay < sent_.size());
  const Wrench& held = sent_[(calls_ + sent_.size() - 1 - account.delay) % sent_.size()];
  const Vec3 quick_n = account.quick_force.step(held.force_n);
  const Vec3 quick_nm = account.quick_torque.step(held.torque_nm);
  account.whole_j += tick_s_ * power(held, twist_);
  account.quick_j += tick_s_ * power({quick_n, quick_nm}, quick_twist_);
  const double held_squared = quick_n.squaredNorm() + quick_nm.squaredNorm() / (kLever_m * kLever_m);
  account.quick_j *= 1 - tick_s_ / kForgetting_s;
  account.quick_j = std::max(account.quick_j, -held_squared / (2 * parameters_.stiffness_n_m));
}

void Passivity::observe(const Pose& device, const Wrench& sent) noexcept {
  sent_[calls_ % sent_.size()] = sent;
  ++calls_;
  if (!known_) {
    last_ = device;
    told_m_.back() = device.position_m;
    told_ = 1;
    known_ = true;
    return;
  }
  const double dead_band_m = deadBand(device.position_m);
  const Vec3 moved_m = beyond(dead_band_m, device.position_m - last_.position_m);
  twist_ = {moved_m / tick_s_, rotationBetween(last_.orientation, device.orientation) / tick_s_};
  last_ = {dead_band_m > 0 ? Vec3(last_.position_m + moved_m) : device.position_m, device.orientation};
  lately_m_ = {lately_m_[1], lately_m_[2], device.position_m - told_m_.back()};
  told_m_ = {told_m_[1], told_m_[2], device.position_m};
  told_ = std::min(told_ + 1, told_m_.size());
  jump_m_s_ = quick_jump_.step(meanWithoutSingleSteps(lately_m_) / tick_s_);
  quick_twist_ = {quick_velocity_.step(twist_.linear_m_s), quick_rotation_.step(twist_.angular_rad_s)};
  for (Account& account : std::span(accounts_).first(account_count_)) {
    count(account);
  }
  const double quick_j = quickInjected();
  forgiven_j_ =
      quick_j > forgiven_j_ ? kForgivenAgain_j : forgiven_j_ + (kForgiven_j - forgiven_j_) * tick_s_ / kForgiveness_s;
  if (parameters_.resolution_m > 0) {
    shaken_j_ *= 1 - tick_s_ / kShakingForgotten_s;
    if (const double excess_j = quick_j - kShakingAllowed_j; excess_j > 0) {
      const double booked_j = std::min(excess_j, kShakingBooked_w * tick_s_);
      shaken_j_ += booked_j;
      for (Account& account : accounts_) {
        account.quick_j -= booked_j;
      }
    }
  }
}

void Passivity::restart() noexcept {
  const double spent_j = std::min(0.0, injected());  // a jump to elsewhere is no error to be made good
  const double shaken_j = shaken_j_;
  *this = Passivity(parameters_, tick_s_);
  for (Account& account : accounts_) {
    account.whole_j = spent_j;
  }
  shaken_j_ = shaken_j;
}

double Passivity::injected() const noexcept {
  double most_j = accounts_[0].whole_j;
  for (std::size_t i = 1; i < account_count_; ++i) {
    most_j = std::max(most_j, accounts_[i].whole_j);
  }
  return most_j;
}

double Passivity::quickInjected() const noexcept {
  double most_j = accounts_[0].quick_j;
  for (std::size_t i = 1; i < account_count_; ++i) {
    most_j = std::max(most_j, accounts_[i].quick_j);
  }
  return most_j;
}

double Passivity::softening() const noexcept {
  HAPTO_ASSERT(shaken_j_ >= 0);
  return 1 / (1 + shaken_j_ / kShakingHalves_j);
}

double Passivity::affordable(const Wrench& wrench) noexcept {
  HAPTO_ASSERT(delay_ < sent_.size());
  const double late_s = static_cast<double>(delay_) * tick_s_;
  const double asked_n =
      std::sqrt(wrench.force_n.squaredNorm() + wrench.torque_nm.squaredNorm() / (kLever_m * kLever_m));
  if (late_s == 0 || asked_n == 0) {
    return 1;
  }
  if (!parameters_.delay_known) {
    const double jump_m_s = power(wrench, {jump_m_s_, quick_twist_.angular_rad_s}) / asked_n;
    const double slow_m_s = kJump_m_s + std::sqrt(noise_m2_) / tick_s_;
    const double damper_n_s_m = kJumpDamper_n_s_m * std::max(0.0, 1 - braked_s_ / kBraked_s);
    const double left = std::clamp(1 - damper_n_s_m * (jump_m_s - slow_m_s) / asked_n, 0.0, 1.0);
    braked_s_ += tick_s_ * (1 - left) - tick_s_ / kBrakedForgotten_s * braked_s_;
    return left;
  }
  // Forces that are already under way, and the resulting movement of the handle.
  Twist twist = twist_;
  const double whole_j = injected();
  double given_j = whole_j;
  for (std::size_t age = delay_; age > 0; --age) {
    const Wrench& on_its_way = sent_[(calls_ + sent_.size() - age) % sent_.size()];
    given_j += tick_s_ * power(on_its_way, twist);
    twist.linear_m_s += tick_s_ / kLightestHandle_kg * on_its_way.force_n;
    twist.angular_rad_s += tick_s_ / (kLightestHandle_kg * kLever_m * kLever_m) * on_its_way.torque_nm;
  }
  const double speed_squared = std::max(squaredSpeed(twist), squaredSpeed(twist_));
  const double left_j = std::max(0.0, kCredit_j - std::max(given_j, whole_j));
  const double gain_m_s = std::sqrt(speed_squared + 2 * left_j / kLightestHandle_kg) - std::sqrt(speed_squared);
  return std::min(1.0, kLightestHandle_kg * gain_m_s / (late_s * asked_n));
}

Wrench Passivity::damping() const noexcept {
  Wrench sum = damper(injected(), twist_, strongest_damper_n_s_m_, tick_s_);
  const Wrench quick = damper(quickInjected() - forgiven_j_, quick_twist_, strongest_damper_n_s_m_, tick_s_);
  sum.force_n += quick.force_n;
  sum.torque_nm += quick.torque_nm;
  return sum;
}

}  // namespace haptolith

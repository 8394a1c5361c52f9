#include "haptolith/teleop/operator/force_agreement.h"

#include <cmath>

namespace haptolith {

namespace {

/// Root of the mean square of what `of` makes of each window between two times.
template <class Of>
double rms(const std::vector<AgreementPoint>& windows, double from_s, double to_s, Of&& of) {
  double sum = 0;
  int count = 0;
  for (const AgreementPoint& window : windows) {
    if (window.time_s > from_s && window.time_s <= to_s) {
      sum += of(window).squaredNorm();
      ++count;
    }
  }
  return count == 0 ? 0 : std::sqrt(sum / count);
}

}  // namespace

void DisplayedForceTrack::add(std::uint64_t index, const Vec3& force_n) {
  const Vec3 before = index == 0 ? Vec3(Vec3::Zero()) : sums_[(index - 1) % kTicks];
  sums_[index % kTicks] = before + force_n;
  next_ = index + 1;
}

std::optional<Vec3> DisplayedForceTrack::mean(std::uint64_t from, std::uint64_t to) const {
  if (from >= to || to >= next_ || next_ - from >= kTicks) {
    return std::nullopt;
  }
  return Vec3((sums_[to % kTicks] - sums_[from % kTicks]) / static_cast<double>(to - from));
}

void ForceAgreement::add(double end_s, double stretch_s, const Vec3& displayed_n, const Vec3& met_n) {
  Window& window = windows_[static_cast<std::int64_t>(std::floor((end_s - stretch_s / 2) / kWindow_s))];
  window.known_s += stretch_s;
  window.displayed_ns += stretch_s * displayed_n;
  window.met_ns += stretch_s * met_n;
}

std::vector<AgreementPoint> ForceAgreement::windows() const {
  std::vector<AgreementPoint> points;
  for (const auto& [number, window] : windows_) {
    if (window.known_s >= kWindow_s / 2) {
      const double middle_s = (static_cast<double>(number) + 0.5) * kWindow_s;
      points.push_back({middle_s, window.displayed_ns / window.known_s, window.met_ns / window.known_s});
    }
  }
  return points;
}

double ForceAgreement::rmsMet(double from_s, double to_s) const {
  return rms(windows(), from_s, to_s, [](const AgreementPoint& window) { return window.met_n; });
}

double ForceAgreement::rmsDifference(double from_s, double to_s) const {
  return rms(windows(), from_s, to_s,
             [](const AgreementPoint& window) { return Vec3(window.displayed_n - window.met_n); });
}

double ForceAgreement::share(double from_s, double to_s) const {
  return rmsDifference(from_s, to_s) / rmsMet(from_s, to_s);
}

}  // namespace haptolith

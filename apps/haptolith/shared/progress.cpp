#include "shared/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "haptolith/core/platform/clock.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/core/stop_asked.h"

#include "shared/output.h"

namespace haptolith {

std::string durationText(double seconds) {
  return seconds < 100        ? fmt::format("{:.0f} s", seconds)
         : seconds < 100 * 60 ? fmt::format("{:.0f} min", seconds / 60)
                              : fmt::format("{:.1f} h", seconds / 3600);
}

Progress::Progress(StatusLine& status, double begun_at)
    : status_(status), began_ns_(monotonicNs()), begun_at_(begun_at), furthest_(begun_at) {}

void Progress::expect(double thread_s, int threads) {
  constexpr double kWorthTelling_s = 30;
  const double seconds = thread_s / threads;
  expected_ = seconds < kWorthTelling_s ? ""
                                        : fmt::format("haptolith: this takes about {} on {}\n", durationText(seconds),
                                                      pluralise(static_cast<std::size_t>(threads), "thread"));
}

bool Progress::tell(std::string_view what, double fraction) {
  const std::scoped_lock lock(mutex_);
  furthest_ = std::clamp(fraction, furthest_, 1.0);
  if (!expected_.empty()) {
    post(std::exchange(expected_, ""));
  }
  status_.tell([&] { return fmt::format("{:.0f} %{}: {}", 100 * furthest_, leftAfter(furthest_), what); });
  return !stopAsked();
}

void Progress::advance(double fraction) {
  const std::scoped_lock lock(mutex_);
  furthest_ = std::clamp(fraction, furthest_, 1.0);
}

std::function<bool(std::string_view, double)> Progress::part(double begin, double end) {
  return [this, begin, end](std::string_view what, double share) { return tell(what, begin + share * (end - begin)); };
}

std::string Progress::leftText() const {
  const std::scoped_lock lock(mutex_);
  return leftAfter(furthest_);
}

std::string Progress::leftAfter(double fraction) const {
  constexpr double kLeastDone = 0.01, kLeast_s = 2;  // less is not sufficient for an estimate
  const double took_s = 1e-9 * static_cast<double>(monotonicNs() - began_ns_);
  const double done = fraction - begun_at_;
  return done < kLeastDone || took_s < kLeast_s || fraction >= 1
             ? ""
             : fmt::format(", about {} left", durationText(took_s * (1 - fraction) / done));
}

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

namespace haptolith {

class StatusLine;

/// Returns "40 s", "12 min", "1.5 h".
[[nodiscard]] std::string durationText(double seconds);

/// Progress of long work: "34 %, about 2 min left: the blade moves". The fraction never decreases. Thread-safe.
class Progress {
 public:
  /// @param begun_at  fraction of the work that is already done.
  explicit Progress(StatusLine& status, double begun_at = 0);

  /// Sets the expected duration; the first tell() prints it if it is at least half a minute.
  /// @param thread_s  duration on one thread, in s.
  void expect(double thread_s, int threads);

  /// Shows the completed fraction of all work, 0 to 1. @return false if the work should stop.
  bool tell(std::string_view what, double fraction);

  /// Sets the fraction without showing it.
  void advance(double fraction);

  /// Returns tell() for a part of the work, with 0 to 1 mapped to `begin` to `end` of the total. Must not outlive this.
  [[nodiscard]] std::function<bool(std::string_view what, double fraction)> part(double begin, double end);

  /// Returns ", about 2 min left"; empty without an estimate.
  [[nodiscard]] std::string leftText() const;

 private:
  [[nodiscard]] std::string leftAfter(double fraction) const;

  StatusLine& status_;
  std::int64_t began_ns_;
  double begun_at_, furthest_;
  std::string expected_;  ///< pending text
  mutable std::mutex mutex_;
};

}  // namespace haptolith

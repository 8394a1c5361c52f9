#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

namespace haptolith {

class StatusLine;

/// "40 s", "12 min", "1.5 h".
[[nodiscard]] std::string durationText(double seconds);

/// How far long work is: "34 %, about 2 min left: the blade moves". The fraction never goes back. For several threads.
class Progress {
 public:
  /// @param begun_at  fraction of the work that was done before.
  explicit Progress(StatusLine& status, double begun_at = 0);

  /// The first tell() prints about how long the work takes, unless that is less than half a minute.
  /// @param thread_s  seconds that one thread would take.
  void expect(double thread_s, int threads);

  /// Shows the fraction of all work that is done, 0 to 1. @return false when the work is to stop.
  bool tell(std::string_view what, double fraction);

  /// The same without showing it.
  void advance(double fraction);

  /// tell() for a part of the work, whose 0 to 1 is `begin` to `end` of the whole. Valid as long as this.
  [[nodiscard]] std::function<bool(std::string_view what, double fraction)> part(double begin, double end);

  /// ", about 2 min left"; empty while that cannot be known.
  [[nodiscard]] std::string leftText() const;

 private:
  [[nodiscard]] std::string leftAfter(double fraction) const;

  StatusLine& status_;
  std::int64_t began_ns_;
  double begun_at_, furthest_;
  std::string expected_;  ///< to be printed
  mutable std::mutex mutex_;
};

}  // namespace haptolith

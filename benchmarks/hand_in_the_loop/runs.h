#pragma once

#include <functional>
#include <string>
#include <vector>

#include "session.h"

namespace hand_in_the_loop {

/// Plays each run in a process of its own, `jobs` at a time, and tells each as soon as it is over: its result, or why
/// there is none. A noisy run that failed is played up to `again` times more. Ctrl-C ends all of them at once, and so
/// does the death of this process.
/// @returns false when it was interrupted.
bool playAll(const std::vector<Settings>& runs, int jobs, int again,
             const std::function<void(const Settings&, const Json* result, const std::string& failure)>& tell);

/// Rows in a CSV file that is added to: a run whose name is there already needs no second time.
class Table {
 public:
  /// Reads what is there. An empty path: rows are kept in memory only.
  explicit Table(std::string path);
  [[nodiscard]] bool has(const std::string& name) const;
  void add(const Json& row);
  [[nodiscard]] const std::vector<Json>& rows() const { return rows_; }

 private:
  std::string path_;
  std::string header_;
  std::vector<Json> rows_;
};

/// The machine may be what is seen: the judge was more than 4 ms late, or the program silent for more than 3 ms.
[[nodiscard]] bool noisy(const Json& row);
/// The verdict is none of the good ones.
[[nodiscard]] bool failed(const Json& row);
/// One line about a run.
[[nodiscard]] std::string lineOf(const Json& row);
/// Per soil and grip what was worst, and every run that failed.
void summarise(const std::vector<Json>& rows);
/// A number as short as five digits are.
[[nodiscard]] std::string shortNumber(double x);

}  // namespace hand_in_the_loop

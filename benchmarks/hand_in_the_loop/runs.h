#pragma once

#include <functional>
#include <string>
#include <vector>

#include "session.h"

namespace hand_in_the_loop {

/// Plays each run in a separate process, `jobs` at a time, and reports each at its end: its result, or the reason for
/// its failure. A noisy run that failed is repeated up to `again` times. Ctrl-C or the end of this process ends all
/// runs.
/// @returns false if interrupted.
bool playAll(const std::vector<Settings>& runs, int jobs, int again,
             const std::function<void(const Settings&, const Json* result, const std::string& failure)>& tell);

/// Rows in a CSV file, which is appended to: runs with an existing name are not repeated.
class Table {
 public:
  /// Reads the existing rows. An empty path: rows are kept in memory only.
  explicit Table(std::string path);
  [[nodiscard]] bool has(const std::string& name) const;
  void add(const Json& row);
  [[nodiscard]] const std::vector<Json>& rows() const { return rows_; }

 private:
  std::string path_;
  std::string header_;
  std::vector<Json> rows_;
};

/// Whether the machine may have affected the result: this program was more than 4 ms late, or haptolith was silent for
/// more than 3 ms.
[[nodiscard]] bool noisy(const Json& row);
/// Whether the verdict is a failure.
[[nodiscard]] bool failed(const Json& row);
/// Returns a one-line summary of a run.
[[nodiscard]] std::string lineOf(const Json& row);
/// Prints the worst values per soil and grip, and every failed run.
void summarise(const std::vector<Json>& rows);
/// Formats a number with five digits.
[[nodiscard]] std::string shortNumber(double x);

}  // namespace hand_in_the_loop

#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/input_file.h"

namespace haptolith {

/// Rows of finite numbers, separated by commas, under a heading that names their columns; lines that are empty or begin
/// with # are passed over. Not for the tick.
class NumberRows {
 public:
  /// @param heading  the first line, as it has to stand there: "t_s,x_m,y_m".
  /// @throws as openInput().
  NumberRows(const std::filesystem::path& path, std::string_view heading, const TextLimits& limits);

  /// The next row into `numbers`, one for each column; false when there is none.
  /// @throws InvalidParameter with file, line, column and value for another heading, anything that is no finite number,
  /// and a missing or extra column; for too many rows; as LineReader.
  [[nodiscard]] bool next(std::span<double> numbers);

  /// "file:line: column", for what is wrong with the row that next() gave.
  [[nodiscard]] std::string key(std::string_view column) const;

  /// How many next() has given.
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  void read(std::string_view line, std::span<double> numbers) const;

  std::filesystem::path path_;
  std::string heading_;
  std::vector<std::string> columns_;
  TextLimits limits_;
  std::ifstream file_;
  LineReader lines_;
  bool heading_seen_ = false;
  std::size_t count_ = 0;
};

}  // namespace haptolith

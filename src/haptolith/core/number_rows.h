#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/input_file.h"

namespace haptolith {

/// Whether a file of numbers may have columns that nobody reads.
enum class OtherColumns { kNone, kPassedOver };

/// Rows of finite numbers, separated by commas, under a heading that names their columns; lines that are empty or begin
/// with # are passed over. Not for the tick.
class NumberRows {
 public:
  /// @param heading  the columns that are read: "t_s,x_m,y_m". With kNone they are the file's first line.
  /// @throws as openInput().
  NumberRows(const std::filesystem::path& path, std::string_view heading, const TextLimits& limits,
             OtherColumns others = OtherColumns::kNone);

  /// The next row into `numbers`, one for each column; false when there is none.
  /// @throws InvalidParameter with file, line, column and value for another heading, anything that is no finite number,
  /// and a missing or extra column; for too many rows; as LineReader.
  [[nodiscard]] bool next(std::span<double> numbers);

  /// "file:line: column", for what is wrong with the row that next() gave.
  [[nodiscard]] std::string key(std::string_view column) const;

  /// How many next() has given.
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  void readHeading(std::string_view line);
  void read(std::string_view line, std::span<double> numbers) const;

  std::filesystem::path path_;
  std::string heading_;
  OtherColumns others_;
  std::vector<std::string> columns_;
  std::vector<std::size_t> places_;  ///< of each in the file
  std::size_t in_file_ = 0;          ///< columns
  TextLimits limits_;
  std::ifstream file_;
  LineReader lines_;
  bool heading_seen_ = false;
  std::size_t count_ = 0;
};

}  // namespace haptolith

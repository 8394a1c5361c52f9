#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <istream>
#include <string>
#include <string_view>

namespace haptolith {

/// Opens a user's file for reading. Regular files only: a pipe or a device may have no end, or no data. Not for the
/// tick.
/// @throws InvalidParameter when there is no such file, or a larger one, or something else of that name; Failure when
/// it cannot be read.
[[nodiscard]] std::ifstream openInput(const std::filesystem::path& path, std::uintmax_t most_bytes);

/// Remembers that this program reads a file, so that it does not write over it (openInput() does so).
void rememberInput(const std::filesystem::path& path);

/// Whether a file is one of those that this program has read, under whatever name.
[[nodiscard]] bool isInput(const std::filesystem::path& path);

/// Limits of a text.
struct TextLimits {
  std::uintmax_t bytes;
  std::size_t line_bytes;
  int rows;  ///< for readers that count rows
};

/// Reads the lines of a text, each no longer than its limit. Lines end with LF, CRLF or CR. Ends when stopAsked().
class LineReader {
 public:
  /// @param name  of the text, for messages.
  LineReader(std::istream& text, std::string_view name, const TextLimits& limits);

  /// The next line, without its end; false when there is none.
  /// @throws InvalidParameter for a line or a text that is too long; Failure when stopAsked().
  [[nodiscard]] bool next(std::string& line);

  /// Number of the line that next() returned; 1 is the first.
  [[nodiscard]] int number() const noexcept { return number_; }

  /// Whether the line that next() gave has a line end; the last line of a file that is cut off has none.
  [[nodiscard]] bool ended() const noexcept { return ended_; }

 private:
  std::streambuf& text_;
  std::string name_;
  TextLimits limits_;
  std::uintmax_t bytes_ = 0;
  int number_ = 0;
  bool ended_ = true;
};

}  // namespace haptolith

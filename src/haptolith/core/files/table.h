#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/input_file.h"

namespace haptolith {

/// Format of a table as its reader expects it.
struct TableFormat {
  /// Names of the columns that are read. They settle which of comma, semicolon and tab separates the cells.
  std::span<const std::string_view> columns;
  TextLimits limits;
  /// Columns of codes, which may begin with #. If the first column is one of them, a line that begins with # and no
  /// space is a row if it has as many cells as the heading.
  std::span<const std::string_view> codes = {};
};

/// A table of text: a heading of column names, and a row of cells for each name below it. Reads what spreadsheets, R,
/// pandas and numpy write:
///
///   - UTF-8 with or without a byte order mark; UTF-16 and workbooks are refused by name
///   - lines that end with LF, CRLF or CR; empty lines, rows of empty cells and comments (# at the beginning) are
///     passed over, as is Excel's first line sep=; and numpy's heading may be a comment
///   - cells separated by comma, semicolon or tab, spaces around them; in double quotes with "" or \" for a quote, and
///     line breaks inside
///   - columns in any order and in any case, among others, which are ignored
///   - numbers such as 1, +1.5, 1e3; 1,5 where the separator is no comma, but not next to 1.5
///
/// Every refusal is an InvalidParameter with file, line and column, the text found and the text expected. Not for the
/// tick.
class Table {
 public:
  using Column = std::size_t;

  /// Reads the heading. @throws InvalidParameter, Failure: as openInput() and LineReader; InvalidParameter for a table
  /// without a heading or with one column twice.
  Table(const std::filesystem::path& path, const TableFormat& format);
  /// @param name  of the table, for messages.
  Table(std::istream& text, std::string_view name, const TableFormat& format);
  ~Table() = default;
  Table(const Table&) = delete;
  Table& operator=(const Table&) = delete;

  /// The column of a name, in any case; none if the table has no such column.
  /// @throws InvalidParameter if two columns differ in case only.
  [[nodiscard]] std::optional<Column> find(std::string_view name) const;
  /// All of these columns. @throws InvalidParameter that lists them if one is missing.
  [[nodiscard]] std::vector<Column> columns(std::span<const std::string_view> names) const;

  /// Reads the next row; false at the end.
  /// @throws InvalidParameter if it has more or fewer cells than the heading, for a quote that is not closed, for bytes
  /// that are no text, and for too many rows; as LineReader.
  [[nodiscard]] bool next();

  /// A cell of the row that next() has read, without spaces around it.
  [[nodiscard]] const std::string& cell(Column column) const { return cells_[column]; }
  [[nodiscard]] std::span<const std::string> cells() const noexcept { return cells_; }
  /// Whether the cell is empty or a word for a missing value: NA, N/A, NaN, null, none.
  [[nodiscard]] bool isMissing(Column column) const;
  /// @throws InvalidParameter unless the cell is a finite number; inside `range`.
  [[nodiscard]] double number(Column column, const Range& range = {});
  /// Yes or no: 1, 1.0, true, T, yes, Y, or 0, 0.0, false, F, no, N; none where the cell isMissing().
  /// @throws InvalidParameter for anything else.
  [[nodiscard]] std::optional<bool> flag(Column column);
  /// Text to show: printable characters of UTF-8. @throws InvalidParameter for anything else.
  [[nodiscard]] const std::string& text(Column column) const;

  /// Line of the row's beginning; 1 is the file's first.
  [[nodiscard]] int line() const noexcept { return line_number_; }
  [[nodiscard]] std::size_t rows() const noexcept { return rows_; }
  /// Whether the row begins with #, not in quotes.
  [[nodiscard]] bool beginsWithHash() const noexcept { return begins_with_hash_; }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  /// "file:line: what", and "file:line: column NAME", the key of what is wrong with the row.
  [[nodiscard]] std::string key(std::string_view what) const;
  [[nodiscard]] std::string key(Column column) const;
  /// @throws InvalidParameter with file, line, column, the cell, and what it must be.
  [[noreturn]] void refuse(Column column, std::string_view valid) const;
  /// @throws InvalidParameter about the heading, with its names.
  [[noreturn]] void refuseHeading(std::string_view valid) const;

 private:
  void readHeading();
  void takeHeading();
  void takeFirstLine();
  void requireText() const;
  void requireWholeRow() const;
  void readCells();
  bool takeLine(std::string_view line);
  std::size_t takeCell(std::string_view line, std::size_t at);
  std::size_t takeQuoted(std::string_view line, std::size_t at);
  [[nodiscard]] std::size_t behindBlanks(std::string_view line, std::size_t at) const;
  [[nodiscard]] bool endsCell(std::string_view line, std::size_t at) const;
  [[nodiscard]] bool isPassedOver();
  [[nodiscard]] std::size_t knownNames(std::string_view line, char separator) const;
  [[nodiscard]] char separatorOf(std::string_view line) const;
  [[nodiscard]] std::string ofTheEnd() const;

  std::string name_;
  TableFormat format_;
  std::ifstream file_;
  LineReader lines_;
  std::vector<std::string> heading_;
  int heading_line_ = 0;
  bool code_first_ = false;

  std::string line_;      ///< as the file has it
  int line_number_ = 0;   ///< first line of the row
  bool waiting_ = false;  ///< line_ has been read, and is not yet a row
  bool begins_with_hash_ = false;
  char separator_ = ',';
  bool separator_given_ = false;
  std::vector<std::string> cells_;
  bool quote_open_ = false;
  std::size_t rows_ = 0;

  char decimal_ = 0;  ///< the mark of the first number that has one, where it may be a comma
  int decimal_line_ = 0;
};

/// Times of a table's rows, in s. They grow from row to row and have any zero. Milliseconds, microseconds and
/// nanoseconds since 1970 are known by the size of the first one: 1e11 s would be later than the year 5000.
class TimeColumn {
 public:
  TimeColumn(Table& table, Table::Column column) : table_(table), column_(column) {}

  /// The time of the row that the table has read.
  /// @throws InvalidParameter as Table::number(), and with both lines unless it is later than that of the row before.
  [[nodiscard]] double read();

 private:
  Table& table_;
  Table::Column column_;
  double per_second_ = 0;
  double last_s_ = 0;
  int last_line_ = 0;  ///< 0: no row so far
};

}  // namespace haptolith

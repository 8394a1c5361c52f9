#include "haptolith/psychometrics/answers_file.h"

#include <boost/tokenizer.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>

#include "haptolith/core/error.h"
#include "haptolith/core/input_file.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

/// A study of a thousand people has some hundred thousand rows; answers to a form make some of them long.
constexpr TextLimits kLimits{.bytes = 256 << 20, .line_bytes = 100'000, .rows = 1'000'000};
constexpr std::size_t kMostColumns = 1000;
constexpr std::size_t kMostCells = 20'000'000;  // some 0.7 GB

/// A line of the table with its number in the file.
struct Row {
  int line = 0;
  std::vector<std::string> cells = {};
};

std::string trimmed(std::string_view text) {
  const auto blank = [](unsigned char letter) { return std::isspace(letter) != 0; };
  while (!text.empty() && blank(static_cast<unsigned char>(text.front()))) {
    text.remove_prefix(1);
  }
  while (!text.empty() && blank(static_cast<unsigned char>(text.back()))) {
    text.remove_suffix(1);
  }
  return std::string(text);
}

std::vector<std::string> cellsOf(const std::string& line, char separator) {
  const boost::escaped_list_separator<char> separators("", std::string(1, separator), "\"");
  std::vector<std::string> cells;
  for (const std::string& cell : boost::tokenizer(line, separators)) {
    cells.push_back(trimmed(cell));
  }
  return cells;
}

char separatorOf(const std::string& header) {
  for (const char separator : {'\t', ';'}) {
    if (header.find(separator) != std::string::npos) {
      return separator;
    }
  }
  return ',';
}

class Table {
 public:
  Table(std::istream& text, std::string_view name) : name_(name) {
    LineReader lines(text, name, kLimits);
    std::string line;
    char separator = ',';
    while (lines.next(line)) {
      const int number = lines.number();
      if (number == 1 && line.starts_with("\xef\xbb\xbf")) {
        line.erase(0, 3);  // some spreadsheets mark UTF-8 so
      }
      if (trimmed(line).empty() || line.starts_with('#')) {
        continue;
      }
      if (header_.cells.empty()) {
        separator = separatorOf(line);
        header_ = {number, cellsOf(line, separator)};
        requireHeader();
      } else {
        rows_.push_back({number, cellsOf(line, separator)});
        requireRow();
      }
    }
    requireHeader();
  }

  [[nodiscard]] const std::vector<Row>& rows() const noexcept { return rows_; }

  /// The first of these columns that the table has.
  [[nodiscard]] std::optional<std::size_t> column(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names) {
      const auto found = std::ranges::find(header_.cells, name);
      if (found != header_.cells.end()) {
        return static_cast<std::size_t>(found - header_.cells.begin());
      }
    }
    return std::nullopt;
  }

  /// The text of a cell; empty when the table has no such column.
  [[nodiscard]] std::string text(const Row& row, std::optional<std::size_t> column) const {
    return column ? row.cells[*column] : "";
  }

  [[nodiscard]] double number(const Row& row, std::size_t column) const {
    const std::string& cell = row.cells[column];
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
      refuse(row, column, "a number");
    }
    return value;
  }

  [[noreturn]] void refuse(const Row& row, std::size_t column, std::string_view valid) const {
    throw InvalidParameter(fmt::format("{}, line {}, column {}", name_, row.line, shortened(header_.cells[column])),
                           inQuotes(row.cells[column]), std::string(valid));
  }

  [[noreturn]] void refuse(std::string_view what, std::string_view valid) const {
    throw InvalidParameter(name_, std::string(what), std::string(valid));
  }

  [[nodiscard]] std::string columns() const {
    return shortened(fmt::format("{}", fmt::join(header_.cells, ", ")), 5 * kQuoteLetters);
  }

 private:
  void requireHeader() const {
    if (header_.cells.empty()) {
      refuse("nothing in it", "a line of column names, x,k,n or x,response, and rows below it");
    }
    if (header_.cells.size() > kMostColumns) {
      refuse(fmt::format("{} columns", header_.cells.size()), fmt::format("at most {}", kMostColumns));
    }
    for (const std::string& name : header_.cells) {
      if (std::ranges::count(header_.cells, name) > 1) {
        refuse(fmt::format("column {} twice", inQuotes(name)), "every column once");
      }
    }
  }

  /// Checks the last one.
  void requireRow() const {
    const Row& row = rows_.back();
    if (row.cells.size() != header_.cells.size()) {
      throw InvalidParameter(fmt::format("{}, line {}", name_, row.line), fmt::format("{} cells", row.cells.size()),
                             fmt::format("{}, as many as columns", header_.cells.size()));
    }
    if (rows_.size() > static_cast<std::size_t>(kLimits.rows) || rows_.size() * header_.cells.size() > kMostCells) {
      refuse(fmt::format("more than {} rows of {} cells", rows_.size() - 1, header_.cells.size()),
             fmt::format("at most {} rows and {} cells", kLimits.rows, kMostCells));
    }
  }

  std::string name_;
  Row header_;
  std::vector<Row> rows_;
};

/// Whether the answer was positive; none where there was no answer.
std::optional<bool> responseOf(const Table& table, const Row& row, std::size_t column) {
  std::string word = row.cells[column];
  std::ranges::transform(word, word.begin(), [](unsigned char letter) { return std::tolower(letter); });
  if (word.empty() || word == "n/a") {
    return std::nullopt;
  }
  if (word == "1" || word == "yes" || word == "true") {
    return true;
  }
  if (word == "0" || word == "no" || word == "false") {
    return false;
  }
  table.refuse(row, column, "1, yes or true; 0, no or false; empty or n/a without an answer");
}

/// The level of a row of x,k,n.
Level countsOf(const Table& table, const Row& row, std::size_t x, std::size_t k, std::size_t n) {
  const Level level{table.number(row, x), table.number(row, k), table.number(row, n)};
  if (level.n < 0 || level.n != std::floor(level.n)) {
    table.refuse(row, n, "a whole number of answers, 0 or more");
  }
  if (level.k < 0 || level.k > level.n || level.k != std::floor(level.k)) {
    table.refuse(row, k, fmt::format("a whole number of positive answers, 0 to n = {}", level.n));
  }
  return level;
}

/// Gathers the levels of each block and participant.
class Answers {
 public:
  void add(const std::string& block, const std::string& participant, const std::string& group, const Level& level) {
    const auto [place, is_new] = places_.try_emplace({block, participant}, answers_.size());
    if (is_new) {
      answers_.push_back({.block = block, .participant = participant, .group = group});
    }
    answers_[place->second].levels.push_back(level);
  }

  [[nodiscard]] std::vector<AnswersOf> pooledLevels(double tolerance) && {
    for (AnswersOf& of : answers_) {
      of.levels = tolerance > 0 ? pooledWithin(of.levels, tolerance) : pooled(of.levels);
    }
    std::erase_if(answers_, [](const AnswersOf& of) { return of.levels.empty(); });
    return std::move(answers_);
  }

 private:
  std::vector<AnswersOf> answers_;
  std::map<std::array<std::string, 2>, std::size_t> places_;
};

}  // namespace

std::vector<AnswersOf> readAnswers(std::istream& text, std::string_view name, double pool_tolerance) {
  requireInRange("pool tolerance", pool_tolerance, {.lowest = 0});
  const Table table(text, name);
  const auto x = table.column({"x", "value"});
  const auto k = table.column({"k"});
  const auto n = table.column({"n"});
  const auto response = table.column({"response", "positive"});
  if (!x || !(response || (k && n))) {
    table.refuse("columns " + table.columns(), "columns x,k,n, or x,response with a row for each trial");
  }
  const auto block = table.column({"block"});
  const auto participant = table.column({"participant"});
  const auto group = table.column({"group"});
  const auto kind = table.column({"kind"});
  const auto state = table.column({"state"});
  const auto participant_state = table.column({"participant_state"});
  Answers answers;
  for (const Row& row : table.rows()) {
    const std::string_view standing = participant_state ? std::string_view(row.cells[*participant_state]) : "";
    const bool left_out = standing == "withdrawn" || standing == "excluded";
    if (left_out || (kind && row.cells[*kind] != "main") || (state && row.cells[*state] != "answered")) {
      continue;
    }
    Level level;
    if (k && n) {
      level = countsOf(table, row, *x, *k, *n);
    } else if (const std::optional<bool> positive = responseOf(table, row, *response)) {
      level = {table.number(row, *x), *positive ? 1.0 : 0.0, 1};
    } else {
      continue;
    }
    answers.add(table.text(row, block), table.text(row, participant), table.text(row, group), level);
  }
  std::vector<AnswersOf> result = std::move(answers).pooledLevels(pool_tolerance);
  if (result.empty()) {
    table.refuse("no answer in it", "one or more");
  }
  return result;
}

std::vector<AnswersOf> readAnswersFile(const std::filesystem::path& path, double pool_tolerance) {
  std::ifstream file = openInput(path, kLimits.bytes);
  return readAnswers(file, path.filename().string(), pool_tolerance);
}

}  // namespace haptolith

#include "haptolith/core/files/table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <set>
#include <system_error>
#include <utility>

#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

constexpr std::size_t kMostColumns = 1000;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// First bytes of files that are mistaken for tables.
struct ForeignFile {
  std::string_view beginning, name, remedy;
};
constexpr std::string_view kSaveAsText = "a table of text: a spreadsheet saves it as CSV";
constexpr std::array kForeignFiles{
    ForeignFile{"\xFF\xFE", "UTF-16", "UTF-8: a spreadsheet saves it as \"CSV UTF-8\""},
    ForeignFile{"\xFE\xFF", "UTF-16", "UTF-8: a spreadsheet saves it as \"CSV UTF-8\""},
    ForeignFile{"PK\x03\x04", "a workbook or another ZIP file", kSaveAsText},
    ForeignFile{"\x1F\x8B", "a file packed by gzip", "unpacked"},
    ForeignFile{"\x89HDF", "an HDF5 file", kSaveAsText},
};

char lowered(char letter) {
  return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
}

std::string lowered(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](char letter) { return lowered(letter); });
  return lower;
}

bool isSameName(std::string_view one, std::string_view other) {
  return std::ranges::equal(one, other, [](char a, char b) { return lowered(a) == lowered(b); });
}

bool isOneOf(std::string_view name, std::span<const std::string_view> names) {
  return std::ranges::any_of(names, [&](std::string_view other) { return isSameName(name, other); });
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\n";
  const std::size_t first = text.find_first_not_of(kBlank);
  return first == std::string_view::npos ? std::string_view{}
                                         : text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// The parts of one line between separators that are not in quotes.
std::vector<std::string_view> partsOf(std::string_view line, char separator) {
  std::vector<std::string_view> parts;
  bool quoted = false;
  std::size_t from = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      quoted = !quoted;
    } else if (line[i] == separator && !quoted) {
      parts.push_back(line.substr(from, i - from));
      from = i + 1;
    }
  }
  parts.push_back(line.substr(from));
  return parts;
}

std::string_view withoutQuotes(std::string_view part) {
  part = trimmed(part);
  return part.size() >= 2 && part.front() == '"' && part.back() == '"' ? trimmed(part.substr(1, part.size() - 2))
                                                                       : part;
}

/// A finite number, with a decimal point and perhaps a plus sign.
std::optional<double> numberFrom(std::string_view text) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') {
    text.remove_prefix(1);
  }
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(number) ? std::optional(number)
                                                                                           : std::nullopt;
}

std::string withDecimalPoint(std::string_view text) {
  std::string number(text);
  std::ranges::replace(number, ',', '.');
  return number;
}

/// A count of a clock in seconds. Whole nanoseconds since 1970 have more digits than a double.
double secondsOf(std::string_view cell, double count, double per_second) {
  std::int64_t whole = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), whole);
  if (error != std::errc() || end != cell.data() + cell.size()) {
    return count / per_second;
  }
  const auto unit = static_cast<std::int64_t>(per_second);
  const std::int64_t seconds = whole / unit;
  return static_cast<double>(seconds) + static_cast<double>(whole % unit) / per_second;
}

}  // namespace

Table::Table(const std::filesystem::path& path, const TableFormat& format)
    : name_(path.string()),
      format_(format),
      file_(openInput(path, format.limits.bytes)),
      lines_(file_, name_, format.limits) {
  readHeading();
}

Table::Table(std::istream& text, std::string_view name, const TableFormat& format)
    : name_(name), format_(format), lines_(text, name, format.limits) {
  readHeading();
}

void Table::readHeading() {
  std::string commented;  // a comment that names columns: numpy's heading, unless another one follows
  int commented_line = 0;
  while (lines_.next(line_)) {
    takeFirstLine();
    requireText();
    line_number_ = lines_.number();
    std::string_view text = trimmed(line_);
    if (text.starts_with('#')) {
      text.remove_prefix(std::min(text.find_first_not_of("# \t"), text.size()));
      if (knownNames(text, separatorOf(text)) > 1) {
        commented = text;
        commented_line = line_number_;
      }
    } else if (!text.empty()) {
      waiting_ = !commented.empty() && knownNames(line_, separatorOf(line_)) == 0;
      break;
    }
    line_.clear();
  }
  if (line_.empty() && commented.empty()) {
    throw InvalidParameter(
        name_, "nothing in it",
        fmt::format("a line of column names, {} among them, and rows below it", fmt::join(format_.columns, ",")));
  }
  if (waiting_ || line_.empty()) {
    line_number_ = commented_line;
    separator_ = separatorOf(commented);
    takeLine(commented);
    quote_open_ = false;
  } else {
    separator_ = separatorOf(line_);
    readCells();
  }
  takeHeading();
}

/// Refuses what is no table, and takes off what is no part of it.
void Table::takeFirstLine() {
  if (lines_.number() > 1) {
    return;
  }
  for (const ForeignFile& foreign : kForeignFiles) {
    if (line_.starts_with(foreign.beginning)) {
      throw InvalidParameter(fmt::format("{}:1: text", name_), std::string(foreign.name), std::string(foreign.remedy));
    }
  }
  if (line_.starts_with(kByteOrderMark)) {
    line_.erase(0, kByteOrderMark.size());
  }
  if (line_.size() == 5 && isSameName(line_.substr(0, 4), "sep=") &&
      std::string_view(",;\t").find(line_[4]) != std::string_view::npos) {
    separator_ = line_[4];
    separator_given_ = true;
    line_.clear();
  }
}

void Table::takeHeading() {
  heading_ = std::exchange(cells_, {});
  heading_line_ = line_number_;
  if (heading_.size() > kMostColumns) {
    throw InvalidParameter(key("header"), fmt::format("{} columns", heading_.size()),
                           fmt::format("at most {}", kMostColumns));
  }
  const bool has_known =
      std::ranges::any_of(heading_, [&](const std::string& name) { return isOneOf(name, format_.columns); });
  if (!has_known) {
    refuseHeading(fmt::format("names of columns, {} among them", fmt::join(format_.columns, ",")));
  }
  std::set<std::string_view> seen;
  for (const std::string& name : heading_) {
    if (!name.empty() && !seen.insert(name).second) {
      throw InvalidParameter(key("header"), fmt::format("column {} twice", inQuotes(name)), "every column once");
    }
  }
  code_first_ = isOneOf(heading_[0], format_.codes);
}

std::size_t Table::knownNames(std::string_view line, char separator) const {
  const std::vector<std::string_view> parts = partsOf(line, separator);
  return static_cast<std::size_t>(std::ranges::count_if(format_.columns, [&](std::string_view known) {
    return std::ranges::any_of(parts, [&](std::string_view part) { return isSameName(known, withoutQuotes(part)); });
  }));
}

/// The separator that gives the most names that are known, or the most cells where none is.
char Table::separatorOf(std::string_view line) const {
  if (separator_given_) {
    return separator_;
  }
  const auto worth = [&](char separator) {
    return std::pair(knownNames(line, separator), partsOf(line, separator).size());
  };
  return std::ranges::max(std::array{',', ';', '\t'}, {}, worth);
}

void Table::requireText() const {
  if (line_.find('\0') != std::string::npos) {
    throw InvalidParameter(fmt::format("{}:{}: text", name_, lines_.number()), "with bytes of 0",
                           "UTF-8; UTF-16 without its byte order mark looks so");
  }
}

std::optional<Table::Column> Table::find(std::string_view name) const {
  const auto has_name = [&](std::string_view other) { return isSameName(name, other); };
  const auto found = std::ranges::find_if(heading_, has_name);
  if (found == heading_.end()) {
    return std::nullopt;
  }
  const auto other = std::find_if(found + 1, heading_.end(), has_name);
  if (other != heading_.end()) {
    throw InvalidParameter(fmt::format("{}:{}: header", name_, heading_line_),
                           fmt::format("columns {} and {}", inQuotes(*found), inQuotes(*other)),
                           fmt::format("one column {}, in whatever case", name));
  }
  return static_cast<Column>(found - heading_.begin());
}

std::vector<Table::Column> Table::columns(std::span<const std::string_view> names) const {
  std::vector<Column> all;
  for (const std::string_view name : names) {
    const std::optional<Column> column = find(name);
    if (!column) {
      refuseHeading(
          fmt::format("columns {}, in any order and among others: there is no {}", fmt::join(names, ","), name));
    }
    all.push_back(*column);
  }
  return all;
}

bool Table::next() {
  for (;;) {
    if (!std::exchange(waiting_, false) && !lines_.next(line_)) {
      return false;
    }
    line_number_ = lines_.number();
    requireText();
    if (isPassedOver()) {
      continue;
    }
    readCells();
    if (std::ranges::all_of(cells_, &std::string::empty)) {
      continue;
    }
    requireWholeRow();
    ++rows_;
    return true;
  }
}

bool Table::isPassedOver() {
  const std::string_view text = trimmed(line_);
  begins_with_hash_ = text.starts_with('#');
  if (!begins_with_hash_) {
    return text.empty();
  }
  const char second = text.size() > 1 ? text[1] : ' ';
  return !code_first_ || second == ' ' || (second == '\t' && separator_ != '\t') || second == '#' ||
         partsOf(line_, separator_).size() != heading_.size();
}

/// Reads the cells of a row that begins in line_, and the lines that belong to its quotes.
void Table::readCells() {
  cells_.clear();
  quote_open_ = false;
  std::size_t bytes = line_.size();
  while (takeLine(line_)) {
    const bool more = lines_.next(line_);
    bytes += line_.size() + 1;
    if (!more || bytes > format_.limits.line_bytes) {
      throw InvalidParameter(
          key("quote"), inQuotes(cells_.back()),
          more ? fmt::format("closed within {} bytes", format_.limits.line_bytes)
               : std::string("closed before the file ends: a quote is missing, or the file is cut off"));
    }
    requireText();
  }
}

/// Adds the cells of a line; returns whether it ends inside a quote that the next line continues.
bool Table::takeLine(std::string_view line) {
  std::size_t at = 0;
  if (quote_open_) {
    cells_.back() += '\n';
    at = takeQuoted(line, at);
  } else {
    at = takeCell(line, at);
  }
  while (!quote_open_ && at < line.size()) {
    at = takeCell(line, at + 1);
  }
  return quote_open_;
}

/// Adds the cell that begins here; returns the place of the separator behind it, or the line's end.
std::size_t Table::takeCell(std::string_view line, std::size_t at) {
  at = behindBlanks(line, at);
  cells_.emplace_back();
  if (at < line.size() && line[at] == '"') {
    quote_open_ = true;
    return takeQuoted(line, at + 1);
  }
  const std::size_t end = std::min(line.find(separator_, at), line.size());
  cells_.back() = trimmed(line.substr(at, end - at));
  return end;
}

/// Adds the rest of a quote, or of the line, to the last cell; returns as takeCell().
std::size_t Table::takeQuoted(std::string_view line, std::size_t at) {
  std::string& cell = cells_.back();
  for (; at < line.size(); ++at) {
    const std::string_view two = line.substr(at, 2);
    if (two == "\"\"" || (two == "\\\"" && !endsCell(line, at + 2))) {
      cell += '"';
      ++at;
    } else if (line[at] != '"') {
      cell += line[at];
    } else {
      quote_open_ = false;
      cell = std::string(trimmed(cell));
      if (!endsCell(line, at + 1)) {
        throw InvalidParameter(key(fmt::format("cell {}", cells_.size())),
                               fmt::format("\"{}\"{}", shortened(cell), shortened(line.substr(at + 1))),
                               "a quote that ends the cell; inside, a quote is written twice");
      }
      return behindBlanks(line, at + 1);
    }
  }
  return at;
}

std::size_t Table::behindBlanks(std::string_view line, std::size_t at) const {
  while (at < line.size() && line[at] != separator_ && (line[at] == ' ' || line[at] == '\t')) {
    ++at;
  }
  return at;
}

bool Table::endsCell(std::string_view line, std::size_t at) const {
  at = behindBlanks(line, at);
  return at == line.size() || line[at] == separator_;
}

void Table::requireWholeRow() const {
  if (cells_.size() != heading_.size()) {
    throw InvalidParameter(
        key("row"), fmt::format("{}, {} cells", inQuotes(line_), cells_.size()),
        fmt::format(
            "{} cells, one for each column{}{}", heading_.size(),
            separator_ == ',' && cells_.size() > heading_.size() ? "; decimal commas take ; or tabs between cells" : "",
            ofTheEnd()));
  }
  if (rows_ == static_cast<std::size_t>(format_.limits.rows)) {
    throw InvalidParameter(key("row"), fmt::format("{}", rows_ + 1), fmt::format("at most {} rows", rows_));
  }
}

std::string Table::ofTheEnd() const {
  return lines_.ended() ? "" : "; the last line has no line end: is the file cut off?";
}

bool Table::isMissing(Column column) const {
  constexpr std::array<std::string_view, 6> kMissing{"", "na", "n/a", "nan", "null", "none"};
  return isOneOf(cells_[column], kMissing);
}

double Table::number(Column column, const Range& range) {
  const std::string& cell = cells_[column];
  const bool has_comma = cell.find(',') != std::string::npos;
  if (has_comma && separator_ == ',') {
    refuse(column, "a finite number with a decimal point; decimal commas take ; or tabs between cells");
  }
  const bool has_point = cell.find('.') != std::string::npos;
  const std::optional<double> number = has_comma ? numberFrom(withDecimalPoint(cell)) : numberFrom(cell);
  if (!number || (has_comma && has_point)) {
    refuse(column, "a finite number");
  }
  const char mark = has_comma ? ',' : '.';
  if ((has_comma || has_point) && separator_ != ',') {
    if (decimal_ != 0 && decimal_ != mark) {
      refuse(column, fmt::format("a number with a decimal {}, as in line {}: one table has one decimal mark",
                                 decimal_ == ',' ? "comma" : "point", decimal_line_));
    }
    if (decimal_ == 0) {
      decimal_ = mark;
      decimal_line_ = line_number_;
    }
  }
  if (!range.contains(*number)) {
    throw InvalidParameter(key(column), *number, range);
  }
  return *number;
}

std::optional<bool> Table::flag(Column column) {
  constexpr std::array<std::string_view, 4> kYes{"true", "t", "yes", "y"}, kNo{"false", "f", "no", "n"};
  if (isMissing(column)) {
    return std::nullopt;
  }
  const std::string word = lowered(cells_[column]);
  const std::optional<double> number = numberFrom(separator_ == ',' ? word : withDecimalPoint(word));
  if (number == 1 || std::ranges::find(kYes, word) != kYes.end()) {
    return true;
  }
  if (number == 0 || std::ranges::find(kNo, word) != kNo.end()) {
    return false;
  }
  refuse(column, "1, true, T, yes or Y; 0, false, F, no or N; empty or NA for none of both");
}

const std::string& Table::text(Column column) const {
  if (!isPlainText(cells_[column])) {
    refuse(column, "printable characters, in UTF-8");
  }
  return cells_[column];
}

std::string Table::key(std::string_view what) const {
  return fmt::format("{}:{}: {}", name_, line_number_, what);
}

std::string Table::key(Column column) const {
  return key(fmt::format("column {}", shortened(heading_[column])));
}

void Table::refuse(Column column, std::string_view valid) const {
  throw InvalidParameter(key(column), inQuotes(cells_[column]), fmt::format("{}{}", valid, ofTheEnd()));
}

void Table::refuseHeading(std::string_view valid) const {
  throw InvalidParameter(fmt::format("{}:{}: header", name_, heading_line_),
                         inQuotes(fmt::format("{}", fmt::join(heading_, ",")), 5 * kQuoteLetters), std::string(valid));
}

double TimeColumn::read() {
  constexpr double kLatest_s = 1e11;
  const double value = table_.number(column_);
  if (last_line_ == 0) {
    const double size = std::abs(value);
    per_second_ = size <= kLatest_s         ? 1
                  : size <= 1e3 * kLatest_s ? 1'000
                  : size <= 1e6 * kLatest_s ? 1'000'000
                                            : 1'000'000'000;
  }
  const double time_s = secondsOf(table_.cell(column_), value, per_second_);
  if (!(std::abs(time_s) <= kLatest_s)) {
    throw InvalidParameter(table_.key(column_), time_s, {-kLatest_s, kLatest_s});
  }
  if (last_line_ > 0 && !(time_s > last_s_)) {
    throw InvalidParameter(table_.key(column_), inQuotes(table_.cell(column_)),
                           fmt::format("later than {} s, the time in line {}: time goes forward", last_s_, last_line_));
  }
  last_s_ = time_s;
  last_line_ = table_.line();
  return time_s;
}

}  // namespace haptolith

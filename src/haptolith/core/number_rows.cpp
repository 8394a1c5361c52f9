#include "haptolith/core/number_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  return first == std::string_view::npos ? std::string_view{}
                                         : text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// What stands between commas, trimmed.
std::vector<std::string_view> fieldsOf(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t comma = 0; comma != std::string_view::npos;) {
    comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
  }
  return fields;
}

}  // namespace

NumberRows::NumberRows(const std::filesystem::path& path, std::string_view heading, const TextLimits& limits,
                       OtherColumns others)
    : path_(path),
      heading_(heading),
      others_(others),
      limits_(limits),
      file_(openInput(path, limits.bytes)),
      lines_(file_, path.string(), limits) {
  for (const std::string_view column : fieldsOf(heading_)) {
    columns_.emplace_back(column);
  }
}

std::string NumberRows::key(std::string_view column) const {
  return fmt::format("{}:{}: {}", path_.string(), lines_.number(), column);
}

bool NumberRows::next(std::span<double> numbers) {
  std::string text;
  while (lines_.next(text)) {
    const std::string_view line = trimmed(text);
    if (line.empty() || line.front() == '#') {
      continue;
    }
    if (!heading_seen_) {
      readHeading(line);
      heading_seen_ = true;
      continue;
    }
    if (count_ == static_cast<std::size_t>(limits_.rows)) {
      throw InvalidParameter(key("row"), fmt::format("{}", count_ + 1), fmt::format("at most {} rows", limits_.rows));
    }
    read(line, numbers);
    ++count_;
    return true;
  }
  return false;
}

void NumberRows::readHeading(std::string_view line) {
  const std::vector<std::string_view> found = fieldsOf(line);
  in_file_ = found.size();
  for (const std::string& column : columns_) {
    const auto place = std::ranges::find(found, column);
    if (place == found.end() || (others_ == OtherColumns::kNone && line != heading_)) {
      throw InvalidParameter(key("header"), inQuotes(line),
                             others_ == OtherColumns::kNone ? fmt::format("'{}'", heading_)
                                                            : fmt::format("columns {}, among others", heading_));
    }
    places_.push_back(static_cast<std::size_t>(place - found.begin()));
  }
}

void NumberRows::read(std::string_view line, std::span<double> numbers) const {
  const std::vector<std::string_view> fields = fieldsOf(line);
  if (fields.size() != in_file_) {
    throw InvalidParameter(key("line"), inQuotes(line), fmt::format("{} numbers", in_file_));
  }
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const std::string_view field = fields[places_[i]];
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), numbers[i]);
    if (error != std::errc{} || end != field.data() + field.size() || !std::isfinite(numbers[i])) {
      throw InvalidParameter(key(columns_[i]), inQuotes(field), "a finite number");
    }
  }
}

}  // namespace haptolith

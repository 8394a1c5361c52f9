#include "haptolith/core/error.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace haptolith {

namespace {

/// Control characters as "\u001b": they would end the text, or command a terminal.
std::string printable(std::string_view text) {
  std::string shown;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    const bool control = (code < 0x20 && c != '\n') || code == 0x7f;
    shown += control ? fmt::format("\\u{:04x}", code) : std::string(1, c);
  }
  return shown;
}

/// A unit of keys that parameters do not have.
struct KeyUnit {
  std::string_view name;
  double in_si;
};

constexpr std::array kKeyUnits{
    KeyUnit{"mm", 1e-3},
    KeyUnit{"ms", 1e-3},
    KeyUnit{"deg", std::numbers::pi / 180},
};

}  // namespace

InvalidParameter::InvalidParameter(std::string key, std::string value, std::string valid)
    : std::invalid_argument(fmt::format("{} = {} is not valid: must be {}", printable(key), printable(value), valid)),
      key_(std::move(key)),
      value_(std::move(value)),
      valid_(std::move(valid)) {}

InvalidParameter::InvalidParameter(const std::string& message, std::string key, std::string value, std::string valid)
    : std::invalid_argument(message), key_(std::move(key)), value_(std::move(value)), valid_(std::move(valid)) {}

RefusedAction::RefusedAction(std::string action, const std::string& message)
    : InvalidParameter(printable(message), std::move(action), "", printable(message)) {}

InvalidParameter::InvalidParameter(std::string key, double value, const Range& range)
    : InvalidParameter(std::move(key), fmt::format("{}", value), range.text()) {
  out_of_range_ = {value, range};
}

double inUnits(double value, double unit) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double number = value / unit;
  for (const double near : {std::round(number * 1e6) * 1e-6, number, std::nextafter(number, -kInfinity),
                            std::nextafter(number, kInfinity)}) {
    if (near * unit == value) {
      return near;
    }
  }
  return number;
}

InvalidParameter inUnitOfKey(const InvalidParameter& error, std::string_view key) {
  if (key == error.key()) {
    return error;
  }
  const std::string_view suffix = key.substr(key.rfind('_') + 1);
  for (const KeyUnit& unit : kKeyUnits) {
    if (unit.name == suffix && error.outOfRange()) {
      const auto& [value, range] = *error.outOfRange();
      return {std::string(key), fmt::format("{}", inUnits(value, unit.in_si)),
              fmt::format("{} ({})", range.in(unit.in_si).text(), unit.name)};
    }
  }
  return {std::string(key), error.value(), fmt::format("{} ({})", error.valid(), error.key())};
}

Range Range::in(double unit) const {
  return {inUnits(lowest, unit), inUnits(highest, unit), ends};
}

bool Range::contains(double value) const noexcept {
  switch (ends) {
    case Ends::kClosed: return value >= lowest && value <= highest;
    case Ends::kOpen: return value > lowest && value < highest;
    case Ends::kOpenBelow: return value > lowest && value <= highest;
  }
  return false;
}

std::string Range::text() const {
  const bool has_lowest = std::isfinite(lowest);
  const bool has_highest = std::isfinite(highest);
  const char* below = ends == Ends::kClosed ? ">=" : ">";
  const char* above = ends == Ends::kOpen ? "<" : "<=";
  if (has_lowest && has_highest) {
    return ends == Ends::kClosed ? fmt::format("{} to {}", lowest, highest)
                                 : fmt::format("{} {} and {} {}", below, lowest, above, highest);
  }
  if (has_lowest) {
    return fmt::format("{} {}", below, lowest);
  }
  if (has_highest) {
    return fmt::format("{} {}", above, highest);
  }
  return "a finite number";
}

double requireInRange(std::string_view key, double value, const Range& range) {
  if (!std::isfinite(value) || !range.contains(value)) {
    throw InvalidParameter(std::string(key), value, range);
  }
  return value;
}

}  // namespace haptolith

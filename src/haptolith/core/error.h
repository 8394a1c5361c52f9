#pragma once

#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace haptolith {

/// Whether the ends of a Range belong to it.
enum class Ends { kClosed, kOpen, kOpenBelow };

/// The valid range of a parameter; infinite ends are allowed and mean "no limit on this side".
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  Ends ends = Ends::kClosed;

  [[nodiscard]] bool contains(double value) const noexcept;
  [[nodiscard]] std::string text() const;  ///< For example "> 0" or "0 to 0.6".
  /// Converts the range to a unit: in(1e-3) of 0 to 0.6 m is 0 to 600 mm.
  [[nodiscard]] Range in(double unit) const;
};

/// The number of `unit`s that is read as exactly `value` (126, not 126.00000000000001), where there is one.
[[nodiscard]] double inUnits(double value, double unit);

/// An invalid value from the caller: names the key, the value and the valid values. Exit status 2.
class InvalidParameter : public std::invalid_argument {
 public:
  InvalidParameter(std::string key, std::string value, std::string valid);
  InvalidParameter(std::string key, double value, const Range& range);

  [[nodiscard]] const std::string& key() const noexcept { return key_; }
  [[nodiscard]] const std::string& value() const noexcept { return value_; }
  [[nodiscard]] const std::string& valid() const noexcept { return valid_; }

  /// A number that is not in its range, for who shows both in another unit.
  struct OutOfRange {
    double value;
    Range range;
  };
  [[nodiscard]] const std::optional<OutOfRange>& outOfRange() const noexcept { return out_of_range_; }

 protected:
  /// @param message  replaces "KEY = VALUE is not valid: must be VALID".
  InvalidParameter(const std::string& message, std::string key, std::string value, std::string valid);

 private:
  std::string key_, value_, valid_;
  std::optional<OutOfRange> out_of_range_;
};

/// An action that is refused in the present state, or a key that is missing: reports `message` alone, for example
/// "nothing to undo: the bed has not been changed". Exit status 2.
class RefusedAction : public InvalidParameter {
 public:
  /// @param action  the action or key, for key().
  RefusedAction(std::string action, const std::string& message);
};

/// States the valid range of a parameter in the unit of its key, although the program keeps it in SI:
/// "14 to 100000 (mm)".
[[nodiscard]] InvalidParameter inUnitOfKey(const InvalidParameter& error, std::string_view key);

/// The input was understood but the work could not be done: disk full, no solution, a device lost. Exit status 1.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns `value` when it is finite and in `range`; the parameter's name carries its unit (`radius_m`).
/// @throws InvalidParameter otherwise, also for NaN.
double requireInRange(std::string_view key, double value, const Range& range);

}  // namespace haptolith

#pragma once

#include <string>
#include <utility>

#include "haptolith/core/error.h"

namespace haptolith {

/// Something in a scene or a soil file is wrong. The text begins with the file and, where one is known, the line:
///
///     scenes/x.toml:12: [soil] rho_max_kg_m3 = 1000 is not valid: must be > 1330 and <= 1e+06
class TomlError : public InvalidParameter {
 public:
  TomlError(std::string message, int line) : TomlError(std::move(message), line, {"scenario", "", ""}) {}

  /// @param wrong  the key ("soil.rho_max_kg_m3"), its value and what would be valid.
  TomlError(std::string message, int line, const InvalidParameter& wrong)
      : InvalidParameter(wrong), message_(std::move(message)), line_(line) {}

  [[nodiscard]] const char* what() const noexcept override { return message_.c_str(); }

  /// 1 is the first; 0 when the error belongs to no line.
  [[nodiscard]] int line() const noexcept { return line_; }

 private:
  std::string message_;
  int line_;
};

}  // namespace haptolith

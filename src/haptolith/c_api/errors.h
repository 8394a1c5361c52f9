#pragma once

#include <haptolith/haptolith.h>

#include <cstdint>
#include <exception>
#include <functional>
#include <string_view>

#include "haptolith/core/error.h"

namespace haptolith::library {

/// Notes what went wrong, for hapto_last_error(), and returns the status.
std::int32_t failed(std::int32_t status, std::string_view message, std::string_view key = {},
                    std::string_view value = {}, std::string_view valid = {}) noexcept;

/// As above with the status's standard text. HAPTO_OK records nothing. @param name  of the invalid argument.
std::int32_t wrongArgument(std::int32_t status, const char* name) noexcept;

/// A function of the C interface has failed, and has noted why.
struct Told {
  std::int32_t status;
};

/// @throws Told unless the status is HAPTO_OK.
inline void requireOk(std::int32_t status) {
  if (status != HAPTO_OK) {
    throw Told{status};
  }
}

/// As above for the exception that is being handled.
std::int32_t failedByException() noexcept;

/// Does `body`, which returns a status or throws: nothing is thrown across the border.
template <class Body>
std::int32_t guarded(Body&& body) noexcept {
  try {
    return std::forward<Body>(body)();
  } catch (...) {
    return failedByException();
  }
}

/// A progress function of the caller, in the forms that the library's parts use.
class Progress {
 public:
  Progress(hapto_progress told, void* user) noexcept : told_(told), user_(user) {}

  /// False: give up. @param share  0 to 1, or -1.
  bool tell(std::string_view what, double share);

  /// The status of work that has thrown: HAPTO_STOPPED where it was the caller's wish.
  [[nodiscard]] std::int32_t status(const std::function<std::int32_t()>& body) noexcept;

 private:
  hapto_progress told_;
  void* user_;
  bool gave_up_ = false;
};

/// Once: HAPTOLITH_CACHE and HAPTOLITH_SIMD. @throws InvalidParameter for an instruction set that is not there.
void readEnvironment();

}  // namespace haptolith::library

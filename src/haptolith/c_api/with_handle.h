#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/handles.h"

namespace haptolith::library {

/// Runs `body` on the target of the handle with exclusive use; returns a status in every case.
/// @param name  of the argument, for messages. @param body  returns a status or nothing, or throws.
template <class H, class Body>
std::int32_t withHandle(const H* handle, const char* name, Body&& body,
                        std::atomic<bool> Handle::*side = &Handle::in_use) {
  const Claim claim(handle, side);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), name);
  }
  return guarded([&]() -> std::int32_t {
    if constexpr (std::is_void_v<decltype(body(*claim))>) {
      std::forward<Body>(body)(*claim);
      return HAPTO_OK;
    } else {
      return std::forward<Body>(body)(*claim);
    }
  });
}

/// As above for calls at 1 kHz, which record no error text. @param argument  that must not be NULL.
template <class H, class Body>
std::int32_t quicklyWith(const H* handle, const void* argument, Body&& body) noexcept {
  if (argument == nullptr) {
    return HAPTO_NULL;
  }
  const Claim claim(handle);
  return claim.status() != HAPTO_OK ? claim.status() : body(*claim);
}

}  // namespace haptolith::library

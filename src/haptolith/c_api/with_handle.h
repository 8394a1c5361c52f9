#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/handles.h"

namespace haptolith::library {

/// Does `body` with what the handle points to, for as long as nobody else may use it; a status, whatever goes wrong.
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

}  // namespace haptolith::library

// The last error of a thread, for libhaptolith and its companion libraries.

#include <haptolith/haptolith.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/values.h"

namespace haptolith::library {

namespace {

/// Last error of one thread. Fixed size, so that exhausted memory can also be reported.
struct LastError {
  std::int32_t status = HAPTO_OK;
  std::array<char, 2048> message{};
  std::array<char, 256> key{}, value{};
  std::array<char, 1024> valid{};
};

LastError& lastError() noexcept {
  thread_local LastError error;
  return error;
}

/// As much of the text as there is room for, in whole characters of UTF-8.
template <std::size_t kRoom>
void put(std::array<char, kRoom>& room, std::string_view text) noexcept {
  std::size_t length = std::min(text.size(), kRoom - 1);
  const auto continues = [&](std::size_t at) {
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
  };
  while (length > 0 && length < text.size() && continues(length)) {
    --length;
  }
  std::copy_n(text.begin(), length, room.begin());
  room[length] = '\0';
}

}  // namespace

std::int32_t failed(std::int32_t status, std::string_view message, std::string_view key, std::string_view value,
                    std::string_view valid) noexcept {
  LastError& error = lastError();
  error.status = status;
  put(error.message, message);
  put(error.key, key);
  put(error.value, value);
  put(error.valid, valid);
  return status;
}

}  // namespace haptolith::library

using haptolith::library::lastError;

std::uint32_t hapto_version() {
  return HAPTO_VERSION;
}

const char* hapto_version_string() {
  return HAPTO_VERSION_STRING;
}

std::int32_t hapto_last_error(hapto_error* out) {
  if (const std::int32_t status = haptolith::library::sizeStatus(out); status != HAPTO_OK) {
    return status;
  }
  const auto& error = lastError();
  haptolith::library::give({.size = 0,
                            .status = error.status,
                            .message = error.message.data(),
                            .key = error.key.data(),
                            .value = error.value.data(),
                            .valid = error.valid.data()},
                           *out);
  return HAPTO_OK;
}

std::int32_t hapto_note_error(std::int32_t status, const char* message, const char* key, const char* value,
                              const char* valid) {
  const auto text = [](const char* given) { return given == nullptr ? std::string_view() : std::string_view(given); };
  return haptolith::library::failed(status, text(message), text(key), text(value), text(valid));
}

const char* hapto_status_text(std::int32_t status) {
  switch (status) {
    case HAPTO_OK: return "ok";
    case HAPTO_INVALID_PARAMETER: return "a value is not valid";
    case HAPTO_FAILURE: return "the operation failed";
    case HAPTO_STOPPED: return "stopped by the progress function";
    case HAPTO_NOT_FINITE: return "a position or velocity is not finite: set another state";
    case HAPTO_COLLAPSED: return "the bed collapsed: set another state";
    case HAPTO_BUSY: return "another thread or a loop is using this handle";
    case HAPTO_DESTROYED: return "the handle is of another type, or it was destroyed";
    case HAPTO_NULL: return "a required pointer is NULL";
    case HAPTO_WRONG_SIZE: return "the member `size` of a struct is less than sizeof the struct in its first version";
    case HAPTO_TOO_SMALL: return "the buffer is too small";
    case HAPTO_NO_MEMORY: return "there is not enough memory";
    case HAPTO_ENDED: return "the loop has ended";
    case HAPTO_WRONG_TOOL: return "the scene has no tool of this number, or not as many tools as there are poses";
    default: return "a status that is unknown to this version";
  }
}

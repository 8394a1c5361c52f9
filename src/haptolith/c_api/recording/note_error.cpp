// For a companion library of libhaptolith: errors are reported by hapto_last_error() of libhaptolith.

#include <string>

#include "haptolith/c_api/errors.h"

namespace haptolith::library {

std::int32_t failed(std::int32_t status, std::string_view message, std::string_view key, std::string_view value,
                    std::string_view valid) noexcept {
  try {
    return hapto_note_error(status, std::string(message).c_str(), std::string(key).c_str(), std::string(value).c_str(),
                            std::string(valid).c_str());
  } catch (...) {  // no memory for the texts
    return hapto_note_error(status, hapto_status_text(status), nullptr, nullptr, nullptr);
  }
}

}  // namespace haptolith::library

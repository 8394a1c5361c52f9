#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace haptolith {

/// `bytes` in base64 (RFC 4648, section 4), with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

/// The bytes again, with or without padding; nothing for text that is no base64.
[[nodiscard]] std::optional<std::string> fromBase64(std::string_view text);

}  // namespace haptolith

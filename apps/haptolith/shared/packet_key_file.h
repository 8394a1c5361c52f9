#pragma once

#include <optional>
#include <string>

namespace haptolith {

/// Returns the key that signs packets, from a file or, without one, from the environment variable; empty: no key. Never
/// from a scene, which may be untrusted. @throws Failure if the file cannot be read.
[[nodiscard]] std::string keyFrom(const std::optional<std::string>& file, const char* variable);

}  // namespace haptolith

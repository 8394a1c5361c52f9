#pragma once

#include <optional>
#include <string>

namespace haptolith {

/// A key that packets are signed with, as it stands in a file or, without one, in the environment's variable; empty:
/// there is none. Never from a scene, which may come from anybody. @throws Failure when the file cannot be read.
[[nodiscard]] std::string keyFrom(const std::optional<std::string>& file, const char* variable);

}  // namespace haptolith

#pragma once

#include <filesystem>

namespace haptolith {

/// Return the user's folders for caches and for logs (XDG Base Directory Specification 0.8): $XDG_CACHE_HOME/haptolith
/// or ~/.cache/haptolith, and $XDG_STATE_HOME/haptolith or ~/.local/state/haptolith. Relative paths and a home that
/// does not exist are ignored. Empty when no path is left. The folder itself may not exist yet.
[[nodiscard]] std::filesystem::path userCacheFolder();
[[nodiscard]] std::filesystem::path userStateFolder();

}  // namespace haptolith

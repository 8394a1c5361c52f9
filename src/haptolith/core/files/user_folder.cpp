#include "haptolith/core/files/user_folder.h"

#include "haptolith/core/platform/files.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

fs::path ours(const fs::path& home) {
  return home.empty() ? home : home / "haptolith";
}

}  // namespace

fs::path userCacheFolder() {
  return ours(cacheHome());
}

fs::path userStateFolder() {
  return ours(stateHome());
}

}  // namespace haptolith

#include "haptolith/core/files/user_folder.h"

#include <cstdlib>

namespace haptolith {

namespace {

namespace fs = std::filesystem;

fs::path absolutePathIn(const char* variable) {
  const char* value = std::getenv(variable);
  const fs::path folder = value == nullptr ? "" : value;
  return folder.is_absolute() ? folder : fs::path();
}

fs::path userFolder(const char* variable, const char* below_home) {
  if (const fs::path folder = absolutePathIn(variable); !folder.empty()) {
    return folder / "haptolith";
  }
  const fs::path home = absolutePathIn("HOME");
  std::error_code ignored;
  return fs::is_directory(home, ignored) ? home / below_home / "haptolith" : fs::path();
}

}  // namespace

fs::path userCacheFolder() {
  return userFolder("XDG_CACHE_HOME", ".cache");
}

fs::path userStateFolder() {
  return userFolder("XDG_STATE_HOME", ".local/state");
}

}  // namespace haptolith

#include "haptolith/core/files/moved_file.h"

#include <fmt/format.h>

#include <string>
#include <system_error>

#include "haptolith/core/former_names.h"

namespace haptolith {

namespace fs = std::filesystem;

fs::path currentPath(const fs::path& path) {
  std::error_code ignored;  // such as a name that is too long for any file
  const fs::path folder = path.parent_path().filename();
  const bool is_scene = folder == "scenarios" || folder == "scenes";
  if ((!is_scene && folder != "protocols") || fs::exists(path, ignored)) {
    return path;
  }
  const NameKind kind = is_scene ? NameKind::kScene : NameKind::kProtocol;
  const std::string name = std::string(currentName(kind, path.stem().string())) + path.extension().string();
  const fs::path current = path.parent_path().parent_path() / (is_scene ? "scenes" : "protocols") / name;
  if (!fs::exists(current, ignored)) {
    return path;
  }
  reportFormerName(fmt::format("{} is now {}", path.string(), current.string()));
  return current;
}

}  // namespace haptolith

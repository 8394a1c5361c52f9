#include "source_dir.h"

namespace haptolith {

const std::filesystem::path& sourceDir() {
  static const std::filesystem::path kFolder(HAPTOLITH_SOURCE_DIR);
  return kFolder;
}

}  // namespace haptolith

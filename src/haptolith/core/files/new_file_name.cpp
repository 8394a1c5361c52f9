#include "haptolith/core/files/new_file_name.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>

namespace haptolith {

std::string newFileName(std::string_view stem, std::string_view ending) {
  const std::string dated = fmt::format("{}-{:%Y%m%d-%H%M%S}", stem, fmt::localtime(std::time(nullptr)));
  std::string name = dated + std::string(ending);
  for (int again = 2; std::filesystem::exists(name); ++again) {
    name = fmt::format("{}-{}{}", dated, again, ending);
  }
  return name;
}

}  // namespace haptolith

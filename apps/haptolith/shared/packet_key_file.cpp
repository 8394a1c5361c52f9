#include "shared/packet_key_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "haptolith/core/error.h"

namespace haptolith {

std::string keyFrom(const std::optional<std::string>& file, const char* variable) {
  constexpr std::size_t kLongest = 200;
  if (!file) {
    const char* said = std::getenv(variable);
    return said != nullptr ? said : "";
  }
  std::ifstream stream(*file);
  std::string key(kLongest, '\0');
  stream.read(key.data(), static_cast<std::streamsize>(key.size()));
  if (stream.bad() || (stream.fail() && !stream.eof())) {
    throw Failure(fmt::format("cannot read the key in '{}'; make one with: openssl rand -hex 32 > '{}'", *file, *file));
  }
  key.resize(static_cast<std::size_t>(stream.gcount()));
  key.erase(std::find_if(key.begin(), key.end(), [](char c) { return c == '\n' || c == '\r'; }), key.end());
  return key.empty() ? "(empty)" : key;  // a key was requested
}

}  // namespace haptolith

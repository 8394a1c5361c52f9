#include "haptolith/study/store/provenance.h"

#include <fmt/format.h>
#include <sodium.h>

#include <array>
#include <fstream>

#include "haptolith/core/platform/this_program.h"

namespace haptolith {

namespace {

/// Returns the text after `key` and `separator` in the first line that begins with the key; empty without such a line.
std::string valueIn(const std::filesystem::path& file, std::string_view key, char separator) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t at = line.find(separator);
    if (line.starts_with(key) && at != std::string::npos) {
      const std::size_t begin = line.find_first_not_of(" \t\"", at + 1);
      const std::size_t end = line.find_last_not_of(" \t\"");
      return begin == std::string::npos ? "" : line.substr(begin, end + 1 - begin);
    }
  }
  return "";
}

}  // namespace

Machine thisMachine(const std::filesystem::path& root) {
  return {.os = valueIn(root / "etc/os-release", "PRETTY_NAME", '='),
          .kernel = systemName(),
          .cpu = valueIn(root / "proc/cpuinfo", "model name", ':')};
}

std::string sha256Of(std::string_view text) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
  const std::string bytes(text);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): libsodium takes bytes
  crypto_hash_sha256(hash.data(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  std::array<char, 2 * crypto_hash_sha256_BYTES + 1> digits{};
  return sodium_bin2hex(digits.data(), digits.size(), hash.data(), hash.size());
}

}  // namespace haptolith

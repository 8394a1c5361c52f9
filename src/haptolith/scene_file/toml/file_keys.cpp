#include "haptolith/scene_file/toml/file_keys.h"

#include <algorithm>
#include <cctype>

namespace haptolith {

std::string anyOf(const std::vector<std::string_view>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : i + 1 == words.size() ? " or " : ", ", words[i]);
  }
  return text;
}

std::string_view currentWord(std::string_view word) noexcept {
  constexpr std::string_view kFormer = "pairwise";  // until 0.1
  const auto same_letter = [](unsigned char a, unsigned char b) { return std::tolower(a) == b; };
  return std::ranges::equal(word, kFormer, same_letter) ? "contact" : word;
}

}  // namespace haptolith

#include "haptolith/core/plain_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace haptolith {

namespace {

/// A letter of UTF-8: its number, and of how many bytes it is.
struct Letter {
  char32_t number = 0;
  std::size_t size = 1;
  bool valid = false;
};

/// The first letter of a text that is not empty.
Letter firstOf(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) {
    return {byte(0), 1, true};
  }
  const std::size_t size = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < size) {
    return {};
  }
  char32_t number = byte(0) & (0xFFU >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) {
      return {};
    }
    number = number << 6U | (byte(i) & 0x3FU);
  }
  constexpr std::array<char32_t, 5> kSmallest{0, 0, 0x80, 0x800, 0x10000};  // smallest code point by number of bytes
  const bool surrogate = number >= 0xD800 && number <= 0xDFFF;
  if (number < kSmallest[size] || number > 0x10FFFF || surrogate) {
    return {};
  }
  return {number, size, true};
}

bool isObeyed(char32_t letter, Lines lines) {
  if (lines == Lines::kSeveral && (letter == U'\n' || letter == U'\t')) {
    return false;
  }
  const bool control = letter < 0x20 || (letter >= 0x7F && letter <= 0x9F);
  const bool separator = letter == 0x2028 || letter == 0x2029;
  const bool direction = letter == 0x200E || letter == 0x200F || (letter >= 0x202A && letter <= 0x202E) ||
                         (letter >= 0x2066 && letter <= 0x2069);
  return control || separator || direction;
}

/// Characters that are invisible or are mistaken for a space or a minus sign.
bool isLookAlike(char32_t letter) {
  constexpr std::array kSingle{U'\u00a0', U'\u00ad', U'\u1680', U'\u180e', U'\u202f', U'\u2212', U'\u3000', U'\ufeff'};
  return (letter >= 0x2000 && letter <= 0x200D) || (letter >= 0x205F && letter <= 0x2064) ||
         std::ranges::find(kSingle, letter) != kSingle.end();
}

enum class LookAlikes { kKept, kShown };

std::string shown(std::string_view text, Lines lines, LookAlikes look_alikes) {
  std::string plain;
  plain.reserve(text.size());
  while (!text.empty()) {
    const Letter letter = firstOf(text);
    if (!letter.valid) {
      plain += "\xEF\xBF\xBD";
    } else if (isObeyed(letter.number, lines) || (look_alikes == LookAlikes::kShown && isLookAlike(letter.number))) {
      plain += fmt::format("\\u{:04x}", static_cast<unsigned>(letter.number));
    } else {
      plain += text.substr(0, letter.size);
    }
    text.remove_prefix(letter.size);
  }
  return plain;
}

std::string beginning(std::string_view text, std::size_t most, LookAlikes look_alikes) {
  std::size_t letters = 0, end = 0;
  while (end < text.size() && letters < most) {
    end += firstOf(text.substr(end)).size;
    ++letters;
  }
  return shown(text.substr(0, end), Lines::kOne, look_alikes) + (end < text.size() ? "..." : "");
}

}  // namespace

std::string plainText(std::string_view text, Lines lines) {
  return shown(text, lines, LookAlikes::kKept);
}

bool isPlainText(std::string_view text, Lines lines) {
  while (!text.empty()) {
    const Letter letter = firstOf(text);
    if (!letter.valid || isObeyed(letter.number, lines)) {
      return false;
    }
    text.remove_prefix(letter.size);
  }
  return true;
}

std::string shortened(std::string_view text, std::size_t most) {
  return beginning(text, most, LookAlikes::kKept);
}

std::string inQuotes(std::string_view text, std::size_t most) {
  return fmt::format("'{}'", beginning(text, most, LookAlikes::kShown));
}

}  // namespace haptolith

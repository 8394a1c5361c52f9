#include "haptolith/study/store/participant_code.h"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstddef>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr std::size_t kLongestCode = 16;
constexpr std::size_t kMostDigits = 6;  // far above the number of participants of a study
constexpr std::string_view kRemoved = "[removed]";

char lower(char letter) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
}

bool isPlain(char letter) {
  const auto byte = static_cast<unsigned char>(letter);
  return byte < 0x80 && std::isalnum(byte) != 0;
}

/// Returns the position of the next occurrence of the code as a word, from `from` on; npos without one.
std::size_t findWord(std::string_view text, std::string_view code, std::size_t from) {
  const auto alike = [](char a, char b) { return lower(a) == lower(b); };
  while (from < text.size()) {
    const auto* const begin = text.data() + from;
    const auto* const end = text.data() + text.size();
    const auto* const found = std::search(begin, end, code.begin(), code.end(), alike);
    if (found == end) {
      break;
    }
    const auto at = static_cast<std::size_t>(found - text.data());
    const std::size_t after = at + code.size();
    if ((at == 0 || !isPlain(text[at - 1])) && (after == text.size() || !isPlain(text[after]))) {
      return at;
    }
    from = at + 1;
  }
  return std::string_view::npos;
}

std::string lowered(std::string_view code) {
  std::string text(code);
  std::ranges::transform(text, text.begin(), lower);
  return text;
}

void startSodium() {
  if (sodium_init() < 0) {
    throw Failure("libsodium cannot be started");
  }
}

}  // namespace

bool isCode(std::string_view code) {
  return !code.empty() && code.size() <= kLongestCode && std::ranges::all_of(code, isPlain);
}

int numberInCode(std::string_view code) {
  if (code.size() < 2 || code.size() > 1 + kMostDigits || lower(code.front()) != 's') {
    return 0;
  }
  int number = 0;
  const char* const end = code.data() + code.size();
  const auto [stopped, error] = std::from_chars(code.data() + 1, end, number);
  return error == std::errc() && stopped == end && number > 0 ? number : 0;
}

std::string hashOfCode(std::string_view code) {
  startSodium();
  const std::string text = lowered(code);
  std::array<char, crypto_pwhash_STRBYTES> hash{};
  if (crypto_pwhash_str(hash.data(), text.data(), text.size(), crypto_pwhash_OPSLIMIT_INTERACTIVE,
                        crypto_pwhash_MEMLIMIT_INTERACTIVE) != 0) {
    throw Failure("not enough memory for the hash of a code: 64 MiB are needed");
  }
  return hash.data();
}

bool isHashOfCode(const std::string& hash, std::string_view code) {
  startSodium();
  const std::string text = lowered(code);
  return crypto_pwhash_str_verify(hash.c_str(), text.data(), text.size()) == 0;
}

std::string withoutCode(std::string_view text, std::string_view code) {
  std::string without;
  std::size_t from = 0;
  for (std::size_t at = findWord(text, code, 0); at != std::string_view::npos; at = findWord(text, code, from)) {
    without.append(text.substr(from, at - from)).append(kRemoved);
    from = at + code.size();
  }
  return without.append(text.substr(from));
}

bool namesCode(std::string_view text, std::string_view code) {
  return findWord(text, code, 0) != std::string_view::npos;
}

}  // namespace haptolith

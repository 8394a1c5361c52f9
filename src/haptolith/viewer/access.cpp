#include "haptolith/viewer/access.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <span>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/files.h"

namespace haptolith {

namespace {

bool equalIgnoringCase(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

/// Four whole numbers up to 255 with dots between them, the first 127.
bool isLoopbackV4(std::string_view address) {
  if (!address.starts_with("127.")) {
    return false;
  }
  int dots = 0;
  int digits = 0;
  int number = 0;
  for (const char c : address) {
    if (c == '.') {
      if (digits == 0) {
        return false;
      }
      ++dots;
      digits = number = 0;
    } else if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
      number = 10 * number + (c - '0');
      if (++digits > 3 || number > 255) {
        return false;
      }
    } else {
      return false;
    }
  }
  return dots == 3 && digits > 0;
}

}  // namespace

bool isLoopback(std::string_view address) {
  return isLoopbackV4(address) || address == "::1" || equalIgnoringCase(address, "localhost");
}

bool namesLoopback(std::string_view host) {
  if (host.starts_with('[')) {  // [::1]:8080
    const std::size_t end = host.find(']');
    return end != std::string_view::npos && isLoopback(host.substr(1, end - 1)) &&
           (end + 1 == host.size() || host[end + 1] == ':');
  }
  std::string_view name = host.substr(0, host.find(':'));
  if (equalIgnoringCase(name, "localhost.")) {  // as it is written in full
    name.remove_suffix(1);
  }
  return isLoopback(name);
}

bool isFromHere(std::string_view origin, std::string_view host) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme)) {
      return !host.empty() && equalIgnoringCase(origin.substr(scheme.size()), host);
    }
  }
  return false;
}

std::string_view tokenOf(std::string_view target) {
  constexpr std::string_view kKey = "token=";
  std::size_t at = target.find('?');
  while (at != std::string_view::npos) {
    const std::string_view rest = target.substr(at + 1);
    if (rest.starts_with(kKey)) {
      return rest.substr(kKey.size(), rest.find('&') - kKey.size());
    }
    at = target.find('&', at + 1);
  }
  return {};
}

bool sameToken(std::string_view a, std::string_view b) noexcept {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

void requireGoodToken(std::string_view token, std::string_view key) {
  const auto is_good = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  const bool good = std::ranges::all_of(token, is_good);
  if (!good || token.size() < kShortestToken || token.size() > kLongestToken) {
    throw InvalidParameter(
        std::string(key),
        good ? fmt::format("a text of {}{} characters", token.size() > kLongestToken ? "more than " : "",
                           std::min(token.size(), kLongestToken))
             : "a text with other characters",
        fmt::format("{} to {} of A to Z, a to z, 0 to 9, - and _", kShortestToken, kLongestToken));
  }
}

std::string newToken() {
  std::array<std::uint8_t, 16> bits{};
  if (!fillWithRandom(std::as_writable_bytes(std::span(bits)))) {
    throw Failure("cannot generate a token: the system provides no random numbers");
  }
  std::string token;
  for (const std::uint8_t byte : bits) {
    token += fmt::format("{:02x}", byte);
  }
  return token;
}

}  // namespace haptolith

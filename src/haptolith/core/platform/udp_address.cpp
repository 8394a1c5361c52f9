#include <fmt/format.h>

#include <charconv>
#include <system_error>

#include "haptolith/core/platform/udp_socket.h"

namespace haptolith {

std::string UdpAddress::text() const {
  return fmt::format("{}.{}.{}.{}:{}", host >> 24U, host >> 16U & 0xFFU, host >> 8U & 0xFFU, host & 0xFFU, port);
}

std::optional<UdpAddress> udpAddressIn(std::string_view text) {
  constexpr std::string_view kLocalHost = "localhost:";
  const std::string numbers =
      text.starts_with(kLocalHost) ? fmt::format("127.0.0.1:{}", text.substr(kLocalHost.size())) : std::string(text);
  const char* at = numbers.data();
  const char* const end = at + numbers.size();
  UdpAddress address;
  for (int part = 0; part < 4; ++part) {
    std::uint8_t number = 0;
    const char* const begin = at;
    const auto [stop, error] = std::from_chars(at, end, number);
    const bool leading_zero = stop - begin > 1 && *begin == '0';
    if (error != std::errc{} || leading_zero || stop == end || *stop != (part < 3 ? '.' : ':')) {
      return std::nullopt;
    }
    address.host = address.host << 8U | number;
    at = stop + 1;
  }
  const auto [stop, error] = std::from_chars(at, end, address.port);
  return error == std::errc{} && stop == end ? std::optional(address) : std::nullopt;
}

}  // namespace haptolith

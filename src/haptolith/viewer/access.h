#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace haptolith {

/// Access control of the view. Any open web page may send requests to any server on the machine, and is
/// identified only by its Origin; a name that an attacker points at 127.0.0.1 is known by the Host.

/// Whether an address is one that only this machine reaches: 127.0.0.0/8, ::1 or localhost.
[[nodiscard]] bool isLoopback(std::string_view address);

/// Whether a Host header, with or without a port, names this machine.
[[nodiscard]] bool namesLoopback(std::string_view host);

/// Whether a page from `origin` ("http://localhost:8080") came from the host it now speaks to ("localhost:8080").
[[nodiscard]] bool isFromHere(std::string_view origin, std::string_view host);

/// Value of `token` in the query of a request's target; empty without one. %xx and + are not decoded: tokens
/// have no such characters.
[[nodiscard]] std::string_view tokenOf(std::string_view target);

/// Compares in constant time.
[[nodiscard]] bool sameToken(std::string_view a, std::string_view b) noexcept;

/// Length limits of a user's token.
inline constexpr std::size_t kShortestToken = 16, kLongestToken = 128;

/// @param key  where the token is from; the token itself is not repeated. @throws InvalidParameter for a token that
/// is too short to be hard to guess, or has letters that an address would have to write another way.
void requireGoodToken(std::string_view token, std::string_view key);

/// 128 random bits in hexadecimal. @throws Failure when the system gives none.
[[nodiscard]] std::string newToken();

}  // namespace haptolith

#pragma once

#include <string>
#include <string_view>

namespace haptolith {

// Codes are the pseudonyms of participants: "S01". They become names of files and folders, and are case-insensitive.

inline constexpr const char* kValidCode = "1 to 16 letters and digits, such as S01";

/// Whether the code is valid: 1 to 16 letters and digits.
[[nodiscard]] bool isCode(std::string_view code);

/// Returns the n of "S<n>", with at most six digits; 0 for any other code.
[[nodiscard]] int numberInCode(std::string_view code);

/// Returns a hash of a removed participant's code, stored so that the code is not assigned again. It is salted and slow
/// to compute (argon2id, libsodium's interactive limits). A short code can still be guessed by trying all codes.
/// @throws Failure if there is not enough memory (64 MiB).
[[nodiscard]] std::string hashOfCode(std::string_view code);
[[nodiscard]] bool isHashOfCode(const std::string& hash, std::string_view code);

/// Returns `text` with "[removed]" instead of the code, wherever it is a separate word.
[[nodiscard]] std::string withoutCode(std::string_view text, std::string_view code);

/// Whether the code is a separate word in `text`.
[[nodiscard]] bool namesCode(std::string_view text, std::string_view code);

}  // namespace haptolith

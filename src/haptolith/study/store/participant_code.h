#pragma once

#include <string>
#include <string_view>

namespace haptolith {

// Codes are the pseudonyms of participants: "S01". They become names of files and folders; upper and lower case are
// alike.

inline constexpr const char* kValidCode = "1 to 16 letters and digits, such as S01";

/// 1 to 16 letters and digits.
[[nodiscard]] bool isCode(std::string_view code);

/// The n of "S<n>", with at most six digits; 0 for any other code.
[[nodiscard]] int numberInCode(std::string_view code);

/// What is kept of the code of somebody who has been removed, so that nobody gets it again: salted and slow to compute
/// (argon2id, libsodium's interactive limits). A code of few letters can still be guessed by trying all of them.
/// @throws Failure when there is no memory for it (64 MiB).
[[nodiscard]] std::string hashOfCode(std::string_view code);
[[nodiscard]] bool isHashOfCode(const std::string& hash, std::string_view code);

/// `text` with "[removed]" in the place of the code, wherever it stands as a word of its own.
[[nodiscard]] std::string withoutCode(std::string_view text, std::string_view code);

/// Whether the code stands in `text` as a word of its own.
[[nodiscard]] bool namesCode(std::string_view text, std::string_view code);

}  // namespace haptolith

#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace haptolith {

/// Length to which a message quotes foreign text.
inline constexpr std::size_t kQuoteLetters = 60;

/// Which control characters text may have.
enum class Lines { kOne, kSeveral };

/// `text` with nothing in it that a terminal or a reader of lines would obey: control characters (of ASCII, DEL, and
/// U+0080 to U+009F), separators of lines and marks that turn the direction of writing become "\u001b", bytes that are
/// not UTF-8 become U+FFFD. With kSeveral, newlines and tabs stay.
[[nodiscard]] std::string plainText(std::string_view text, Lines lines = Lines::kOne);

/// Whether plainText() would change anything.
[[nodiscard]] bool isPlainText(std::string_view text, Lines lines = Lines::kOne);

/// plainText() of its first letters, and "..." when there are more than `most`.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t most = kQuoteLetters);

/// plainText() in quotes, for messages: 'title'. Also escapes characters that are invisible or are mistaken for a space
/// or a minus sign: '0.5\u00a0'.
[[nodiscard]] std::string inQuotes(std::string_view text, std::size_t most = kQuoteLetters);

}  // namespace haptolith

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace haptolith {

/// "saved NAME: WHAT\n" for each file that the program has written and not yet told of: rows and columns of a table,
/// the size of anything else. Studies are left out: their commands tell what is in them.
[[nodiscard]] std::string savedText();

/// The same for one file of which a command knows more; savedText() leaves it out then.
[[nodiscard]] std::string savedText(const std::filesystem::path& path, std::string_view what);

}  // namespace haptolith

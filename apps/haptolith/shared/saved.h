#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace haptolith {

/// Returns "saved NAME: WHAT\n" for each written file that was not reported yet: rows and columns of a table, the size
/// of other files. Studies are left out, because their commands report the content.
[[nodiscard]] std::string savedText();

/// As above for one file with a description from the command; the function above then leaves it out.
[[nodiscard]] std::string savedText(const std::filesystem::path& path, std::string_view what);

}  // namespace haptolith

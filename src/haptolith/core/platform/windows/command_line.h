#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace haptolith {

/// Text for a function of Windows, from UTF-8.
[[nodiscard]] std::wstring wideOf(std::string_view utf8);

[[nodiscard]] std::string utf8Of(std::wstring_view wide);

/// Arguments as one line, from which CommandLineToArgvW() makes the same arguments.
[[nodiscard]] std::wstring commandLine(const std::vector<std::string>& arguments);

}  // namespace haptolith

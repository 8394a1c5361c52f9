#pragma once

#include <string>
#include <string_view>

namespace haptolith {

/// For example "haptolith-20260102-030405.h5": local time, and a number when that is taken. In the current folder.
[[nodiscard]] std::string newFileName(std::string_view stem, std::string_view ending);

}  // namespace haptolith

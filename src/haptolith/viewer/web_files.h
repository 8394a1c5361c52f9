#pragma once

#include <span>
#include <string_view>

namespace haptolith {

/// A file of the page, built into the program.
struct WebFile {
  std::string_view path;  ///< "/index.html"
  std::string_view content;
};

/// The files of web/dist; cmake/EmbedWeb.cmake writes them.
[[nodiscard]] std::span<const WebFile> webFiles();

}  // namespace haptolith

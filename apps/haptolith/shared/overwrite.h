#pragma once

#include <string>

#include "haptolith/core/files/atomic_file.h"

namespace CLI {
class App;
}  // namespace CLI

namespace haptolith {

/// --overwrite, the option of every command that writes files: without it none replaces a file that is there.
struct Overwrite {
  bool allowed = false;

  void addTo(CLI::App& command);

  /// A file that the command writes.
  [[nodiscard]] OutputFile operator()(const std::string& path) const {
    return {path, allowed ? IfThere::kReplace : IfThere::kRefuse};
  }
};

}  // namespace haptolith

#pragma once

#include <string>

#include "haptolith/core/files/atomic_file.h"

namespace CLI {
class App;
}  // namespace CLI

namespace haptolith {

/// Option --overwrite of every command that writes files; without it existing files are not replaced.
struct Overwrite {
  bool allowed = false;

  void addTo(CLI::App& command);

  /// Returns an output file of the command.
  [[nodiscard]] OutputFile operator()(const std::string& path) const {
    return {path, allowed ? IfThere::kReplace : IfThere::kRefuse};
  }
};

}  // namespace haptolith

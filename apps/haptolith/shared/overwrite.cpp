#include "shared/overwrite.h"

#include <CLI/App.hpp>

namespace haptolith {

void Overwrite::addTo(CLI::App& command) {
  command.add_flag("--overwrite", allowed, "Let files that are written replace files that are there");
}

}  // namespace haptolith

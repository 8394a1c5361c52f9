#pragma once

#include <CLI/CLI.hpp>

namespace haptolith {

/// Adds `haptolith export`. It runs while `app` parses, which then throws as for addSoilCommands().
void addExportCommand(CLI::App& app);

}  // namespace haptolith

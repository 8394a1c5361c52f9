#pragma once

#include <CLI/CLI.hpp>

namespace haptolith {

/// Adds `haptolith study export`. It runs while the program's arguments are parsed, which then throws as for
/// addSoilCommands().
void addStudyExportCommand(CLI::App& study);

}  // namespace haptolith

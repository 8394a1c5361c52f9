#pragma once

#include <CLI/CLI.hpp>

namespace haptolith {

/// Adds `haptolith study status`. It runs while the program's arguments are parsed, which then throws as for
/// addSoilCommands().
void addStudyStatusCommand(CLI::App& study);

}  // namespace haptolith

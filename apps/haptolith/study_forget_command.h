#pragma once

#include <CLI/CLI.hpp>

namespace haptolith {

/// Adds `haptolith study forget`. It runs while the program's arguments are parsed, which then throws as for
/// addSoilCommands().
void addStudyForgetCommand(CLI::App& study);

}  // namespace haptolith

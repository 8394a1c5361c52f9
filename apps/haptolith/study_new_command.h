#pragma once

#include <CLI/CLI.hpp>

namespace haptolith {

/// Adds `haptolith study new`. It runs while the program's arguments are parsed, which then throws as for
/// addSoilCommands().
void addStudyNewCommand(CLI::App& study);

}  // namespace haptolith

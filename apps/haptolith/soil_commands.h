#pragma once

#include <CLI/CLI.hpp>

namespace haptolith {

/// Adds `haptolith soil profile`, `soil calibrate` and `soil presets`. They run while `app` parses.
/// Parsing then throws CLI::ParseError for wrong usage, InvalidParameter for a wrong value, Failure for work undone.
void addSoilCommands(CLI::App& app);

}  // namespace haptolith

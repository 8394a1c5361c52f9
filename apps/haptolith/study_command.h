#pragma once

#include <CLI/CLI.hpp>

namespace haptolith {

/// Adds `haptolith study` with its commands. They run while `app` parses.
/// Parsing then throws CLI::ParseError for wrong usage, InvalidParameter for a wrong value, Failure for work undone.
void addStudyCommand(CLI::App& app);

}  // namespace haptolith

#pragma once

#include <CLI/CLI.hpp>

namespace haptolith {

/// Adds `fit`: a psychometric function for the answers in a table. It runs while the command line is parsed.
void addStudyFitCommand(CLI::App& study);

}  // namespace haptolith

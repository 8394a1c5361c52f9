#pragma once

#include <CLI/CLI.hpp>

namespace haptolith {

/// Adds `explore`: what a hand feels of the paper's stimuli, and how far apart they are. It runs while the command line
/// is parsed.
void addStudyExploreCommand(CLI::App& study);

}  // namespace haptolith

#pragma once

#include <string>

namespace haptolith {

/// Result of a finished program.
struct ProgramResult {
  int exit_status = -1;  ///< -1 when a signal ended it
  std::string output;    ///< standard output
  std::string errors;    ///< standard error
};

/// Runs `haptolith ARGUMENTS` in a shell, neither stream being a terminal. The arguments may redirect standard output
/// (`run > /dev/full`).
ProgramResult runHaptolith(const std::string& arguments);

/// Runs a shell command in which "$HAPTOLITH" stands for the program and "$RECORDING_HELPER" for tests/recording's: for
/// signals, limits and pipes.
ProgramResult runInShell(const std::string& command);

}  // namespace haptolith

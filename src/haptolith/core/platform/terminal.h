#pragma once

#include <cstddef>

namespace haptolith {

// Not for the tick.

/// Whether the descriptor is a terminal.
[[nodiscard]] bool isTerminal(int descriptor) noexcept;

/// Width of the terminal in letters; 0 if it is unknown.
[[nodiscard]] std::size_t terminalColumns(int descriptor) noexcept;

/// Lets terminals show UTF-8 and colours, where that has to be asked for.
void prepareTerminals() noexcept;

}  // namespace haptolith

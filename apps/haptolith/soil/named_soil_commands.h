#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// Adds `soil list` and `soil show`.
void addNamedSoilCommands(CLI::App& soil);

}  // namespace haptolith

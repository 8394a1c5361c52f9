#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// Adds `haptolith bench`.
void addBenchCommand(CLI::App& app);

}  // namespace haptolith

#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// `haptolith study run` and `resume`.
void addStudyRunCommands(CLI::App& study);

}  // namespace haptolith

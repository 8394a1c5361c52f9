#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// `haptolith study simulate`.
void addStudySimulateCommand(CLI::App& study);

}  // namespace haptolith

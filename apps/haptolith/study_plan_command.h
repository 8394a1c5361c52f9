#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// `haptolith study plan`.
void addStudyPlanCommand(CLI::App& study);

}  // namespace haptolith

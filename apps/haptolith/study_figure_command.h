#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// `haptolith study figure`.
void addStudyFigureCommand(CLI::App& study);

}  // namespace haptolith

#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// `haptolith run`: a scene at 1 kHz under a hand.
void addRunCommand(CLI::App& app);

}  // namespace haptolith

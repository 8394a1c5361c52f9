#pragma once

namespace CLI {
class App;
}

namespace haptolith {

void addReplayCommand(CLI::App& app);

}  // namespace haptolith

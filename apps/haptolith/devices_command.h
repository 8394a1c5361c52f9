#pragma once

namespace CLI {
class App;
}

namespace haptolith {

void addDevicesCommand(CLI::App& app);

}  // namespace haptolith

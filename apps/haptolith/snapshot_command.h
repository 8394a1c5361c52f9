#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// Adds `haptolith snapshot`: the page in the browser as a picture or a film, without a screen.
void addSnapshotCommand(CLI::App& app);

}  // namespace haptolith

#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// `haptolith study ...`: user studies, docs/studies.md.
void addStudyCommand(CLI::App& app);

}  // namespace haptolith

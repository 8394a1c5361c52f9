#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// `haptolith lab`: virtual tests of a soil laboratory, calibration and the report.
void addLabCommand(CLI::App& app);

}  // namespace haptolith

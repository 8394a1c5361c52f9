#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace haptolith {

/// `haptolith teleop bench`.
void addTeleopBench(CLI::App& teleop);

}  // namespace haptolith

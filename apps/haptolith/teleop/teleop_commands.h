#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace haptolith {

// Each function adds its command to `haptolith teleop`.
void addTeleopBench(CLI::App& teleop);
void addTeleopOperator(CLI::App& teleop);
void addTeleopRobot(CLI::App& teleop);
void addTeleopRos2(CLI::App& teleop);

}  // namespace haptolith

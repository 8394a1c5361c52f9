// Replacement for the commands that need Cyclone DDS, in a build without it.

#include <CLI/App.hpp>

#include "haptolith/core/error.h"

#include "commands.h"
#include "teleop/teleop_commands.h"

namespace haptolith {

namespace {

void addMissing(CLI::App& app, const char* name, const char* what) {
  CLI::App* command = app.add_subcommand(name, what);
  command->allow_extras();
  command->callback([] {
    throw Failure(
        "ROS 2 is not available: this program was built without DDS; install cyclonedds-dev and cyclonedds-tools "
        "(apt-get install cyclonedds-dev cyclonedds-tools) and build it again (cmake --fresh --preset release)");
  });
}

}  // namespace

void addRos2Command(CLI::App& app) {
  addMissing(app, "ros2", "Run a scene as a ROS 2 node; not available: built without DDS");
}

void addTeleopRos2(CLI::App& teleop) {
  addMissing(teleop, "ros2", "Connect a ROS 2 robot to an operator; not available: built without DDS");
}

}  // namespace haptolith

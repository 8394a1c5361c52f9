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
        "this program was built without DDS, which ROS 2 talks by: install cyclonedds-dev and cyclonedds-tools "
        "(apt-get install cyclonedds-dev cyclonedds-tools) and build it again (cmake --fresh --preset release)");
  });
}

}  // namespace

void addRos2Command(CLI::App& app) {
  addMissing(app, "ros2", "Run a scene as a node of ROS 2; not in this program, which was built without DDS");
}

void addTeleopRos2(CLI::App& teleop) {
  addMissing(teleop, "ros2", "Be the end of a robot with ROS 2; not in this program, which was built without DDS");
}

}  // namespace haptolith

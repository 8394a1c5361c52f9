#pragma once

#include "haptolith/ros2/ros2_node.h"

namespace CLI {
class App;
}  // namespace CLI

namespace haptolith {

/// Options for the ROS 2 graph to join.
struct Ros2Options {
  Ros2Parameters node;

  void addTo(CLI::App& command);
};

}  // namespace haptolith

#include "ros2/ros2_options.h"

#include <CLI/App.hpp>
#include <fmt/format.h>

#include "shared/option_checks.h"

namespace haptolith {

void Ros2Options::addTo(CLI::App& command) {
  command.add_option("--node-name", node.name.node, fmt::format("Name of the node [{}]", node.name.node))
      ->option_text("NAME");
  command.add_option("--ros-namespace", node.name.node_namespace, "Namespace of the node and its topics [/]")
      ->option_text("/NAME");
  command.add_option("--domain", node.domain, "DDS domain [ROS_DOMAIN_ID, else 0]")
      ->check(wholeNumberIn(Ros2Ranges::domain))
      ->option_text("N");
  command.add_flag("--localhost", node.localhost, "Use this machine only, as ROS_LOCALHOST_ONLY=1 [the whole network]");
}

}  // namespace haptolith

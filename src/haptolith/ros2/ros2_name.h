#pragma once

#include <string>
#include <string_view>

namespace haptolith {

/// A node's name and namespace, and the names that follow from them.
struct Ros2Name {
  std::string node = "haptolith";    ///< letters, digits and underscores; no digit first
  std::string node_namespace = "/";  ///< "/" or "/site" or "/site/left"

  /// The topic's full name: "/haptolith/tool_pose" for "~/tool_pose", "/site/scan" for "scan", itself for "/tf".
  /// @throws InvalidParameter for what ROS 2 does not take as a topic's name.
  [[nodiscard]] std::string topic(std::string_view name) const;
};

/// @throws InvalidParameter for names that ROS 2 does not take.
void validate(const Ros2Name& name);

/// Name of the topic in DDS: "rt/tf" for "/tf".
[[nodiscard]] std::string ddsTopic(std::string_view full_name);

}  // namespace haptolith

#pragma once

namespace haptolith {

// Descriptions of the commands of `haptolith-workbench`, also listed by `haptolith --help`.

inline constexpr const char* kLabDescription = "A soil laboratory: what a bed of macroparticles really does";
inline constexpr const char* kStudyDescription = "User studies: from the protocol to the psychometric curve";
inline constexpr const char* kIdentifyDescription = "Friction, cohesion and density of soil from forces on a tool";
inline constexpr const char* kTeleopDescription = "Dig far away: links with delay, and what they do to a hand";
inline constexpr const char* kRos2Description =
    "Run a scene as `haptolith run` does, as a node of ROS 2: poses, wrenches and soil out, targets in";
inline constexpr const char* kBenchDescription = "How long a tick takes, by number of particles, friction and threads";
inline constexpr const char* kCompletionDescription = "Print a script that completes commands and options in a shell";

}  // namespace haptolith

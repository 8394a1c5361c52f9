#pragma once

namespace haptolith {

// Descriptions of the commands of `haptolith-workbench`, also listed by the help of `haptolith`.

inline constexpr const char* kLabDescription = "Simulate soil-mechanics tests of the particle bed";
inline constexpr const char* kTrustDescription = "Find out how far the force of a scene can be believed";
inline constexpr const char* kSoilCalibrateDescription =
    "Calibrate particles to a friction angle, cohesion and bulk density";
inline constexpr const char* kStudyDescription = "Run user studies: from the protocol to the psychometric curve";
inline constexpr const char* kIdentifyDescription = "Estimate friction, cohesion and density of soil from tool forces";
inline constexpr const char* kTeleopDescription = "Teleoperate: delayed links, a simulated robot, an operator station";
inline constexpr const char* kRos2Description =
    "Run a scene as a ROS 2 node that publishes poses, wrenches and soil and subscribes to targets";
inline constexpr const char* kBenchDescription =
    "Measure the time of a tick by number of particles, friction model and threads";
inline constexpr const char* kCompletionDescription = "Print a script that completes commands and options in a shell";

}  // namespace haptolith

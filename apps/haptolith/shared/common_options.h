#pragma once

#include <CLI/App.hpp>

namespace haptolith {

// Descriptions of options that several commands have.

inline constexpr const char* kThreadsHelp = "Number of threads; the result does not depend on it";
inline constexpr const char* kSeedHelp = "Seed of the random numbers";
inline constexpr const char* kFigureHelp = "Draw the result to this file (.svg or .png)";
inline constexpr const char* kSoilHelp = "Soil: a name (haptolith soil list), a soil file, or P1 to P6";
inline constexpr const char* kBodyHelp = "Celestial body: Ceres, Pluto, Europa, Moon, Mars or Earth";
inline constexpr const char* kResumeHelp = "Continue an interrupted command";
inline constexpr const char* kSetHelp = "Set a key of the scene, for example bed.depth_mm=60; can be repeated";
inline constexpr const char* kStudyFileHelp = "Study file";
inline constexpr const char* kProtocolHelp = "Protocol: a built-in name or a file";

/// --json of all commands.
inline CLI::Option* addJson(CLI::App& command, bool& json) {
  return command.add_flag("--json", json, "Print the result as one JSON object");
}

}  // namespace haptolith

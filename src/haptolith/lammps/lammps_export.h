#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/core/timed_pose.h"
#include "haptolith/lammps/lammps_law.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Run of a bed in LAMMPS.
struct LammpsRun {
  std::string title = {};
  std::string program = {};   ///< writing program, with its version
  double dt_s = 0;            ///< duration of a step
  double duration_s = 0;      ///< without a tool; otherwise its path determines it
  double dump_every_s = 0.1;  ///< from picture to picture
  LammpsLaw law = LammpsLaw::kStandard;
  const ToolParameters* tool = nullptr;
  /// scene_T_tool, at least two in order of time; between two of them the tool moves at constant speed, along a line
  /// and about an axis.
  std::vector<TimedPose> path = {};
  /// Kind of each particle; empty: kSoil, and kHeld if it is fixed. Bodies (kBody and more) are moved by
  /// added commands.
  std::vector<int> kinds = {};

  static constexpr int kSoil = 1, kHeld = 2, kTool = 3, kBody = 4;
};

/// An input script of LAMMPS in two parts, and what it reads.
struct LammpsFiles {
  std::string data;   ///< bed.data
  std::string table;  ///< rest.table, of soil whose law is not exactly LAMMPS'; else empty
  std::string setup;  ///< everything before the first step
  std::string path;   ///< path of the tool, and the steps; without a tool the steps alone
  GranularLaw law;
  std::size_t tool_spheres = 0;
  int soil_types = 1;  ///< LAMMPS' types 1 to this are soil, by size; then comes what is held, the tool, each body

  [[nodiscard]] std::string input() const { return setup + path; }
  /// LAMMPS' type of a kind other than soil.
  [[nodiscard]] int typeOf(int kind) const noexcept { return soil_types + kind - 1; }
};

/// The bed as it lies, for LAMMPS: contacts by granularLaw(), walls as they are, grains that do not turn, a tool of
/// spheres (toolSpheres()) that follows its path and whose force is printed. The slip of contacts is
/// lost.
/// @throws InvalidParameter as granularLaw() and toolSpheres(); for jaws, which are not one rigid body, and for a path
/// with fewer than two poses.
[[nodiscard]] LammpsFiles lammpsFiles(const Bed& bed, const LammpsRun& run);

}  // namespace haptolith

#pragma once

#include <string>
#include <vector>

#include "haptolith/lammps/lammps_law.h"

namespace haptolith {

struct LammpsExportOptions {
  std::string file;                    ///< recording (.h5) or scene
  std::vector<std::string> overrides;  ///< scene keys
  std::string out;                     ///< new folder; empty: named after the file
  double from_s = 0;                   ///< for a recording: time of the bed, and begin of the tool's path
  double duration_s = 1;               ///< for a scene
  LammpsLaw pair_style = LammpsLaw::kStandard;
};

/// Writes a bed as a LAMMPS input script with its data files to a new folder. For a recording the tool follows its
/// recorded path; a scene has no tool. @throws InvalidParameter, Failure.
void exportLammps(const LammpsExportOptions& options);

}  // namespace haptolith

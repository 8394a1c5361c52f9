#pragma once

#include <string>
#include <vector>

namespace haptolith {

struct LammpsExportOptions {
  std::string file;                    ///< a recording (.h5) or a scene
  std::vector<std::string> overrides;  ///< keys of a scene
  std::string out;                     ///< a new folder; empty: named after the file
  double from_s = 0;                   ///< of a recording: the bed as it is then, and the tool's way from there on
  double duration_s = 1;               ///< of a scene
  bool own_law = false;                ///< for LAMMPS that has haptolith's law built in
};

/// A bed as an input script of LAMMPS with what it reads, in a new folder: of a recording with its tool, which goes the
/// recorded way; of a scene alone. @throws InvalidParameter, Failure.
void exportLammps(const LammpsExportOptions& options);

}  // namespace haptolith

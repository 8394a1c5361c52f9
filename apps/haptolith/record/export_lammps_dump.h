#pragma once

#include <filesystem>

namespace haptolith {

/// Whether a file begins as a text dump of LAMMPS does.
[[nodiscard]] bool isLammpsDump(const std::filesystem::path& path);

/// Every picture of a dump as a file of VTK, in a new folder, with particles.pvd, which has their times: seconds where
/// the dump tells them, else numbers of steps. @throws InvalidParameter, Failure.
void exportLammpsDump(const std::filesystem::path& path, const std::filesystem::path& out);

}  // namespace haptolith

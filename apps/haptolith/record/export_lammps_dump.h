#pragma once

#include <filesystem>

namespace haptolith {

/// Whether a file begins like a text dump of LAMMPS.
[[nodiscard]] bool isLammpsDump(const std::filesystem::path& path);

/// Writes every snapshot of a dump as a VTK file to a new folder, with their times in particles.pvd: seconds if the
/// dump contains them, otherwise numbers of steps. @throws InvalidParameter, Failure.
void exportLammpsDump(const std::filesystem::path& path, const std::filesystem::path& out);

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "haptolith/core/vec.h"

namespace haptolith {

/// A grain of a picture that LAMMPS has written.
struct DumpedGrain {
  std::int64_t id = 0;
  int type = 1;  ///< in a dump of haptolith's script, a kind of LammpsRun
  Vec3 centre_m = Vec3::Zero();
  double radius_m = 0;
  Vec3 velocity_m_s = Vec3::Zero();
};

/// One of a dump's pictures.
struct LammpsPicture {
  std::int64_t step = 0;
  std::optional<double> time_s = {};  ///< if the dump has it (dump_modify time yes)
  bool has_velocities = false;
  std::size_t number = 0;           ///< in the file, 1 is the first
  std::vector<DumpedGrain> grains;  ///< in the order of their ids
};

/// Reads a text file of `dump custom` (or `dump atom` and others with such headings) that has the columns id, x, y, z
/// and radius, in whatever order and among others; type where there is one, else 1; velocities where there are. A
/// variable of the script's, v_radius or v_type, goes before what LAMMPS itself has of that name. Coordinates may be
/// scaled (xs) or unwrapped through periodic sides (xu, xsu): they are taken into the box; a diameter is halved. A file
/// that its writer has not finished has the pictures that are whole; a picture may be empty, as of a box before grains
/// are poured into it.
/// @param number  which picture, 1 is the first; none: the last that is whole.
/// @param progress  receives the number of skipped pictures; false gives up.
/// @throws InvalidParameter with file, line and what is missing for a file that is no such dump, that has no such
/// picture or an empty one there, in which an id comes twice, or whose units are not si; Failure when it cannot be
/// read, or `progress` gives up.
[[nodiscard]] LammpsPicture readLammpsDump(const std::filesystem::path& path, std::optional<std::size_t> number = {},
                                           const std::function<bool(std::size_t)>& progress = {});

/// Every picture of such a file that is whole, in order. @throws as readLammpsDump(), and what `visit` throws.
void forEachLammpsPicture(const std::filesystem::path& path, const std::function<void(const LammpsPicture&)>& visit);

}  // namespace haptolith

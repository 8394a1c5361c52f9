#include "record/export_lammps_dump.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_folder.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/lammps/lammps_dump.h"
#include "haptolith/recording/picture_meshes.h"
#include "haptolith/recording/vtu_file.h"

#include "shared/output.h"
#include "shared/saved.h"

namespace haptolith {

namespace {

std::array<float, 3> floats(const Vec3& of) {
  return {static_cast<float>(of.x()), static_cast<float>(of.y()), static_cast<float>(of.z())};
}

double timeOf(const LammpsPicture& picture) {
  return picture.time_s.value_or(static_cast<double>(picture.step));
}

VtuFile fileOf(const LammpsPicture& picture) {
  std::vector<std::array<float, 3>> position_m, velocity_m_s;
  std::vector<std::int32_t> id, type;
  std::vector<float> radius_m;
  for (const DumpedGrain& grain : picture.grains) {
    position_m.push_back(floats(grain.centre_m));
    velocity_m_s.push_back(floats(grain.velocity_m_s));
    id.push_back(static_cast<std::int32_t>(grain.id));
    type.push_back(grain.type);
    radius_m.push_back(static_cast<float>(grain.radius_m));
  }
  VtuFile file({.point_m = position_m, .cells = numbered(position_m.size()), .points_per_cell = 1});
  file.addTime(timeOf(picture));
  file.addPointData(kId, id);
  file.addPointData("type", type);
  file.addPointData(kRadius, radius_m);
  if (picture.has_velocities) {
    file.addPointData(kVelocity, velocity_m_s);
  }
  return file;
}

}  // namespace

bool isLammpsDump(const std::filesystem::path& path) {
  constexpr std::string_view kBegins = "ITEM: ";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    return false;
  }
  std::string begins(kBegins.size(), ' ');
  std::ifstream(path).read(begins.data(), static_cast<std::streamsize>(begins.size()));
  return begins == kBegins;
}

void exportLammpsDump(const std::filesystem::path& path, const std::filesystem::path& out) {
  const AtomicFolder folder(out);
  VtkCollection pictures;
  StatusLine status;
  std::size_t count = 0;
  std::map<double, std::size_t> pictures_at;
  forEachLammpsPicture(path, [&](const LammpsPicture& picture) {
    throwIfStopped();
    const std::string name = fmt::format("particles-{:06}.vtu", count++);
    folder.write(name, fileOf(picture).text());
    pictures.add(timeOf(picture), name);
    ++pictures_at[timeOf(picture)];
    status.tell([&] { return pluralise(count, "frame"); });
  });
  folder.write("particles.pvd", pictures.text());
  folder.commit();
  status.clear();
  printText(savedText(folder.path(), fmt::format("{} of the particles", pluralise(count, "frame"))));
  for (const auto& [time, pictures_then] : pictures_at) {
    if (pictures_then > 1) {
      spdlog::warn("{}: {} frames have the step or time {:g}: ParaView shows one of them", path.string(), pictures_then,
                   time);
      break;
    }
  }
}

}  // namespace haptolith

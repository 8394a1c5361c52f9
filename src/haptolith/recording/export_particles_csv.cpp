#include <fmt/format.h>

#include <iterator>
#include <string>

#include "haptolith/recording/export_pictures.h"

namespace haptolith {

void exportParticlesCsv(RecordedPictures& pictures, const std::function<void(std::string_view)>& write) {
  write(fmt::format("t_s,tick,id,x_m,y_m,z_m,radius_m,contact_force_n{}\n",
                    pictures.replays() ? ",vx_m_s,vy_m_s,vz_m_s" : ""));
  std::string lines;
  pictures.forEach([&](const ScenePicture& picture) {
    lines.clear();
    for (std::size_t i = 0; i < picture.position_m.size(); ++i) {
      // The time is written as `export --format csv` writes it, so that the two tables can be joined.
      fmt::format_to(std::back_inserter(lines), "{},{},{},{},{},{}", picture.time_s, picture.tick, i,
                     fmt::join(picture.position_m[i], ","), picture.radius_m[i], picture.contact_force_n[i]);
      if (pictures.replays()) {
        fmt::format_to(std::back_inserter(lines), ",{}", fmt::join(picture.velocity_m_s[i], ","));
      }
      lines += '\n';
    }
    write(lines);
  });
}

}  // namespace haptolith

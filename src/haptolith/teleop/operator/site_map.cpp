#include "haptolith/teleop/operator/site_map.h"

#include <limits>

namespace haptolith {

bool SiteMap::take(const SitePacket& packet) {
  if (packet.robot_connection != robot_session_ || packet.grid != grid_) {
    robot_session_ = packet.robot_connection;
    grid_ = packet.grid;
    heights_m_.assign(grid_.cells(), std::numeric_limits<double>::quiet_NaN());
    known_.assign(grid_.cells(), false);
    numbers_.assign(grid_.cells(), 0);
    commands_.assign(grid_.cells(), 0);
  }
  bool news = false;
  for (std::size_t i = 0; i < packet.steps.size(); ++i) {
    const std::size_t cell = (packet.row + i / packet.columns) * grid_.columns + packet.column + i % packet.columns;
    if (!known_[cell] || packet.number > numbers_[cell]) {
      known_[cell] = true;
      numbers_[cell] = packet.number;
      commands_[cell] = packet.index;
      heights_m_[cell] = packet.steps[i] == SitePacket::kNotSeen ? std::numeric_limits<double>::quiet_NaN()
                                                                 : packet.steps[i] * SitePacket::kStep_m;
      news = true;
    }
  }
  taken_ += news ? 1 : 0;
  return news;
}

}  // namespace haptolith

// Packets to a robot or an operator: an accepted packet is plausible, and is written as it was read.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "haptolith/teleop/link/teleop_packet.h"
#include "haptolith/teleop/operator/site_map.h"

namespace {

void require(bool right) {
  if (!right) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace haptolith;
  const std::span bytes(data, size);
  if (const auto command = parseCommand(bytes)) {
    for (const Keyframe& key : command->keyframes) {
      require(key.hand.pose.position_m.allFinite() && key.hand.pose.position_m.cwiseAbs().maxCoeff() <= 10);
      require(std::abs(key.hand.pose.orientation.norm() - 1) < 1e-12);
      require(key.hand.opening >= 0 && key.hand.opening <= 1);
    }
    const auto again = parseCommand(bytesOf(*command));
    require(again && again->keyframes.size() == command->keyframes.size() && again->number == command->number);
  }
  if (const auto state = parseState(bytes)) {
    for (const RobotReport& report : state->reports) {
      require(report.met.force_n.allFinite() && report.ticks <= report.index);
    }
    const auto again = parseState(bytesOf(*state));
    require(again && again->reports.size() == state->reports.size() && again->state == state->state);
  }
  if (const auto seen = parseSite(bytes)) {
    SiteMap map;
    require(map.take(*seen) && map.heights().size() == seen->grid.cells());
    const auto again = parseSite(bytesOf(*seen));
    require(again && again->steps == seen->steps && again->grid == seen->grid);
  }
  return 0;
}

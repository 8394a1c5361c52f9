// Packets to a network device: each is refused for one reason, or is plausible for a hand and is written as it was
// read.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include "haptolith/device/drivers/device_packet.h"

namespace {

void require(bool right) {
  if (!right) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace haptolith;
  const auto bytes = std::as_bytes(std::span(data, size));
  if (const auto answer = parseAnswer(bytes)) {
    require(answer->output.wrench.force_n.allFinite() && answer->output.wrench.torque_nm.allFinite());
    require(parseAnswer(bytesOf(*answer)).has_value());
  }
  constexpr auto kNone = static_cast<PacketFault>(kPacketFaults);
  PacketFault fault = kNone;
  const auto packet = parse(bytes, &fault);
  require(packet.has_value() == (fault == kNone));
  if (!packet) {
    return 0;
  }
  require(packet->pose.position_m.cwiseAbs().maxCoeff() <= 10 && packet->pose.position_m.allFinite());
  require(std::abs(packet->pose.orientation.norm() - 1) < 1e-12);
  require(packet->twist.linear_m_s.cwiseAbs().maxCoeff() <= 100 && packet->twist.linear_m_s.allFinite());
  require(packet->twist.angular_rad_s.cwiseAbs().maxCoeff() <= 1000 && packet->twist.angular_rad_s.allFinite());
  require(packet->gripper_open >= 0 && packet->gripper_open <= 1);
  const auto again = bytesOf(*packet);
  require(parse(again).has_value());
  require(std::memcmp(again.data() + 8, data + 8, 40) == 0);  // number, buttons, time, position
  return 0;
}

#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "haptolith/teleop/link/link_end.h"
#include "haptolith/teleop/link/packet_seal.h"
#include "haptolith/teleop/link/site_packet.h"
#include "haptolith/teleop/link/teleop_packet.h"
#include "haptolith/teleop/link/udp_port.h"
#include "haptolith/teleop/robot/robot.h"

namespace haptolith {

/// A robot's end of a link: passes received commands to it, and reports its state to the operator. The first
/// sender holds the robot until it has been silent for three seconds. Not for the tick.
class RobotServer {
 public:
  /// Listens. @throws InvalidParameter, Failure: as UdpPort and PacketSeal; InvalidParameter for an address beyond this
  /// machine without a key, unless that is asked for.
  RobotServer(Robot& robot, const EndOptions& options, double tick_s);

  /// Takes what has come; tick the robot after it, and call answer() then.
  void receive();
  /// Once per tick: sends the robot's state to the operator, when due.
  void answer();
  /// Sends the robot's view of the site to the operator, if connected.
  void show(SitePacket packet);

  [[nodiscard]] std::uint16_t port() const { return port_.port(); }
  [[nodiscard]] const PacketCounts& counts() const noexcept { return counts_; }
  [[nodiscard]] const std::string& operatorAddress() const noexcept { return operator_; }

 private:
  void take(const UdpPort::Datagram& datagram);

  Robot& robot_;
  EndOptions options_;
  UdpPort port_;
  PacketSeal seal_;
  KeyframeHistory<RobotReport> history_;
  PacketCounts counts_;
  std::string operator_;
  std::uint64_t ticks_ = 0, heard_tick_ = 0, period_, forgotten_after_;
  std::uint32_t connection_ = 0;
  std::uint64_t number_ = 0;
  std::set<std::uint32_t> over_;  ///< sessions that another has followed
  StatePacket state_;
};

}  // namespace haptolith

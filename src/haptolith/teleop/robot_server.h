#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "haptolith/teleop/packet_seal.h"
#include "haptolith/teleop/robot.h"
#include "haptolith/teleop/site_packet.h"
#include "haptolith/teleop/teleop_packet.h"
#include "haptolith/teleop/udp_port.h"

namespace haptolith {

/// Packets that came, and what became of them.
struct PacketCounts {
  std::uint64_t taken = 0;
  std::uint64_t malformed = 0;
  std::string first_malformed = {};  ///< why the first was not read
  std::uint64_t forged = 0;          ///< do not prove that their sender knows the key
  std::uint64_t greetings = 0;       ///< of who does not know this end's nonce yet
  std::uint64_t replayed = 0;        ///< older than another, or of a session that is over
  std::uint64_t strangers = 0;       ///< of others, while somebody is heard

  [[nodiscard]] bool operator==(const PacketCounts&) const = default;
};

struct EndOptions {
  std::string listen = "127.0.0.1:7410";
  std::string key;        ///< 64 hexadecimal digits; empty: packets are not signed
  bool insecure = false;  ///< without a key also beyond this machine
  Sending sending;
};

/// A robot's end of a link: gives it the commands that come, and tells the operator how it fares. Whoever is heard
/// first has the robot until it has been silent for three seconds. Not for the tick.
class RobotServer {
 public:
  /// Listens. @throws InvalidParameter, Failure: as UdpPort and PacketSeal; InvalidParameter for an address beyond this
  /// machine without a key, unless that is asked for.
  RobotServer(Robot& robot, const EndOptions& options, double tick_s);

  /// Takes what has come; tick the robot after it, and call answer() then.
  void receive();
  /// Once a tick: tells the operator where the robot is, when that is due.
  void answer();
  /// Tells the operator, if there is one, what the robot sees of its site.
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
  KeyHistory<RobotReport> history_;
  PacketCounts counts_;
  std::string operator_;
  std::uint64_t ticks_ = 0, heard_tick_ = 0, period_, forgotten_after_;
  std::uint32_t session_ = 0;
  std::uint64_t number_ = 0;
  std::set<std::uint32_t> over_;  ///< sessions that another has followed
  StatePacket state_;
};

/// A number to call a session by: drawn, never 0.
[[nodiscard]] std::uint32_t newSession();

/// @param key, address  where packets come from or go to. @throws InvalidParameter when that is no address, or is
/// beyond this machine while packets are not signed and nobody has asked for that.
void requireSafe(const char* key, const std::string& address, const EndOptions& options);

}  // namespace haptolith

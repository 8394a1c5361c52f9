#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "haptolith/haptics/tick_record.h"
#include "haptolith/teleop/link/link_end.h"
#include "haptolith/teleop/link/packet_seal.h"
#include "haptolith/teleop/link/udp_port.h"
#include "haptolith/teleop/operator/force_agreement.h"
#include "haptolith/teleop/operator/site_map.h"

namespace haptolith {

/// State of the robot as known to the operator.
struct RobotNews {
  bool heard = false;        ///< in the last second, more than the round trip
  bool ever = false;         ///< at all
  double round_trip_s = 0;   ///< round trip of the newest packet
  std::uint64_t behind = 0;  ///< commands between the newest sent and the newest executed one
  StatePacket state;         ///< the newest
  Vec3 displayed_n = Vec3::Zero(), met_n = Vec3::Zero();  ///< in the newest stretch of commands of which both are known
};

/// Listener for data from a robot; functions may be empty.
struct RobotListener {
  /// Each new report, and the mean of what was felt over the same commands; none: the robot followed none, or they are
  /// too long ago.
  std::function<void(const RobotReport& report, const std::optional<Vec3>& displayed_n)> report = {};
  /// Receives new parts of its site.
  std::function<void(const SitePacket& seen)> seen = {};
};

/// An operator's end of a link: sends the tool's pose of each tick to a robot, and compares the displayed force, before
/// the device's limits, with the remote force. Not for the tick: the thread that follows the loop calls it.
class OperatorEnd {
 public:
  /// @param to         where the robot listens, HOST:PORT.
  /// @param surface_m  height of the soil's surface in the operator's scene: the site frame's zero.
  /// @throws InvalidParameter, Failure: as RobotServer.
  OperatorEnd(const std::string& to, const EndOptions& options, double surface_m, double tick_s);

  /// Takes the loop's ticks since the last call, consecutive.
  void follow(std::span<const TickRecord> ticks);
  /// Takes what has come.
  void receive(const RobotListener& listener = {});

  [[nodiscard]] double surface() const noexcept { return surface_m_; }
  [[nodiscard]] const RobotNews& news() const noexcept { return news_; }
  /// The received map of the site.
  [[nodiscard]] const SiteMap& site() const noexcept { return site_; }
  [[nodiscard]] const ForceAgreement& agreement() const noexcept { return agreement_; }
  [[nodiscard]] const PacketCounts& counts() const noexcept { return counts_; }
  /// Number of followed ticks: the index of the next.
  [[nodiscard]] std::uint64_t ticks() const noexcept { return next_; }
  [[nodiscard]] std::uint64_t sent() const noexcept { return command_.number; }

 private:
  void take(const StatePacket& packet, const RobotListener& listener);
  void take(const SitePacket& packet, const RobotListener& listener);

  std::string to_;
  EndOptions options_;
  double surface_m_, tick_s_;
  UdpPort port_;
  PacketSeal seal_;
  KeyframeHistory<Keyframe> history_;
  CommandPacket command_;
  std::uint64_t next_ = 0, period_;  ///< index of the next tick
  DisplayedForceTrack displayed_;
  ForceAgreement agreement_;
  std::set<std::uint64_t> known_;  ///< reports of the last half minute
  std::uint64_t executed_ = 0;
  std::int64_t heard_ns_ = 0;
  PacketCounts counts_;
  RobotNews news_;
  SiteMap site_;
};

}  // namespace haptolith

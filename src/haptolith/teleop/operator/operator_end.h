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

/// How the robot fares, as far as the operator knows.
struct RobotNews {
  bool heard = false;        ///< in the last second, more than the round trip
  bool ever = false;         ///< at all
  double round_trip_s = 0;   ///< of the newest packet
  std::uint64_t behind = 0;  ///< commands between the newest that was sent and the newest that was carried out
  StatePacket state;         ///< the newest
  Vec3 displayed_n = Vec3::Zero(), met_n = Vec3::Zero();  ///< in the newest stretch of commands of which both are known
};

/// Who is told what has come from a robot; functions may be missing.
struct RobotListener {
  /// Each new report, and the mean of what was felt over the same commands; none: the robot followed none, or they are
  /// too long ago.
  std::function<void(const RobotReport& report, const std::optional<Vec3>& displayed_n)> report = {};
  /// What it sees of its site, where that is news.
  std::function<void(const SitePacket& seen)> seen = {};
};

/// An operator's end of a link: tells a robot where the tool is in each tick, and sets what the hand felt, but for its
/// device's limits, beside what the robot met. Not for the tick: whoever follows the loop calls it.
class OperatorEnd {
 public:
  /// @param to         where the robot listens, HOST:PORT.
  /// @param surface_m  height of the soil's surface in the operator's scene: the site frame's zero.
  /// @throws InvalidParameter, Failure: as RobotServer.
  OperatorEnd(const std::string& to, const EndOptions& options, double surface_m, double tick_s);

  /// What the loop has done since the last call: ticks one after the other.
  void follow(std::span<const TickRecord> ticks);
  /// Takes what has come.
  void receive(const RobotListener& listener = {});

  [[nodiscard]] double surface() const noexcept { return surface_m_; }
  [[nodiscard]] const RobotNews& news() const noexcept { return news_; }
  /// What the robot has shown of its site.
  [[nodiscard]] const SiteMap& site() const noexcept { return site_; }
  [[nodiscard]] const ForceAgreement& agreement() const noexcept { return agreement_; }
  [[nodiscard]] const PacketCounts& counts() const noexcept { return counts_; }
  /// How many ticks it has followed: the index of the next.
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

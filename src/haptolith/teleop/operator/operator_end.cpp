#include "haptolith/teleop/operator/operator_end.h"

#include <algorithm>
#include <cmath>

#include "haptolith/core/platform/clock.h"

namespace haptolith {

namespace {

constexpr int kMostReportsAtOnce = 1024;
constexpr double kSilence_s = 1;  // beyond the round trip

/// Default without a port: any, because its address is not published.
EndOptions fromAnywhere(EndOptions options, const std::string& to) {
  options.listen = to.starts_with('[') ? "[::]:0" : "0.0.0.0:0";
  return options;
}

}  // namespace

OperatorEnd::OperatorEnd(const std::string& to, const EndOptions& options, double surface_m, double tick_s)
    : to_(to),
      options_(fromAnywhere(options, to)),
      surface_m_(surface_m),
      tick_s_(tick_s),
      port_("connect", options_.listen),
      seal_(options.key),
      history_(commandLags(options.sending.period_s, options.sending.command_keyframes)),
      period_(static_cast<std::uint64_t>(std::llround(options.sending.period_s / tick_s))) {
  requireSafe("connect", to, options);
  command_.connection = newConnection();
}

void OperatorEnd::follow(std::span<const TickRecord> ticks) {
  for (const TickRecord& tick : ticks) {
    displayed_.add(next_, tick.rendered.wrench.force_n);
    if (next_ % period_ == 0) {
      Keyframe key;
      key.index = next_;
      key.hand = {{tick.scene_T_tool, tick.device.twist}, tick.device.gripper_open};
      key.hand.pose.position_m.z() -= surface_m_;
      command_.keyframes = history_.add(key);
      command_.held = tick.trip == 0 && tick.device.state == DeviceState::kLive;
      if (!news_.heard) {  // a robot that was started again knows nothing of the nonce of the one before
        seal_.forget();
      }
      command_.sender_time = static_cast<std::uint64_t>(monotonicNs());
      ++command_.number;
      port_.send(to_, seal_.seal(bytesOf(command_)));
    }
    ++next_;
  }
}

void OperatorEnd::receive(const RobotListener& listener) {
  for (int i = 0; i < kMostReportsAtOnce; ++i) {
    const std::optional<UdpPort::Datagram> datagram = port_.receive();
    if (!datagram) {
      break;
    }
    const PacketSeal::Opened opened = seal_.open(datagram->bytes);
    if (opened.proof != PacketSeal::Proof::kFresh) {
      ++counts_.forged;
      continue;
    }
    if (const std::optional<StatePacket> packet = parseState(opened.packet)) {
      take(*packet, listener);
    } else if (const std::optional<SitePacket> seen = parseSite(opened.packet)) {
      take(*seen, listener);
    } else if (counts_.malformed++ == 0) {
      counts_.first_malformed = describeMalformedReport(opened.packet);
    }
  }
  const double silent_s = static_cast<double>(monotonicNs() - heard_ns_) * 1e-9;
  news_.heard = news_.ever && silent_s < kSilence_s + news_.round_trip_s;
  news_.behind = next_ > executed_ ? next_ - executed_ : 0;
}

void OperatorEnd::take(const StatePacket& packet, const RobotListener& listener) {
  const bool same_robot = news_.ever && packet.robot_connection == news_.state.robot_connection;
  if (same_robot && packet.number <= news_.state.number) {
    ++counts_.replayed;
    return;
  }
  ++counts_.taken;
  heard_ns_ = monotonicNs();
  news_.ever = true;
  news_.state = packet;
  if (packet.operator_connection != command_.connection) {  // it has not heard of this run yet
    return;
  }
  news_.round_trip_s = static_cast<double>(heard_ns_ - static_cast<std::int64_t>(packet.sender_time)) * 1e-9;
  for (const RobotReport& report : packet.reports) {
    if (!known_.insert(report.index).second || report.index >= next_) {
      continue;
    }
    executed_ = std::max(executed_, report.index);
    const std::optional<Vec3> displayed_n = displayed_.mean(report.index - report.ticks, report.index);
    if (displayed_n) {
      agreement_.add(static_cast<double>(report.index) * tick_s_, report.ticks * tick_s_, *displayed_n,
                     report.met.force_n);
      news_.displayed_n = *displayed_n;
      news_.met_n = report.met.force_n;
    }
    if (listener.report) {
      listener.report(report, displayed_n);
    }
  }
  while (!known_.empty() && *known_.begin() + DisplayedForceTrack::kTicks < executed_) {
    known_.erase(known_.begin());
  }
}

void OperatorEnd::take(const SitePacket& packet, const RobotListener& listener) {
  // A map may be from before this run, numbered by another operator's commands.
  const bool is_own = news_.ever && packet.robot_connection == news_.state.robot_connection && packet.index < next_;
  if (!is_own || !site_.take(packet)) {
    ++counts_.replayed;
    return;
  }
  ++counts_.taken;
  if (listener.seen) {
    listener.seen(packet);
  }
}

}  // namespace haptolith

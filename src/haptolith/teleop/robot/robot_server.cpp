#include "haptolith/teleop/robot/robot_server.h"

#include <cmath>
#include <optional>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr double kForgottenAfter_s = 3;
constexpr int kMostAtOnce = 256;         // limit per tick in a flood; the rest waits
constexpr std::size_t kMostOver = 4096;  // remembered sessions

}  // namespace

RobotServer::RobotServer(Robot& robot, const EndOptions& options, double tick_s)
    : robot_(robot),
      options_(options),
      port_("listen", options.listen),
      seal_(options.key),
      history_(reportLags(options.sending.report_keys)),
      period_(static_cast<std::uint64_t>(std::llround(options.sending.period_s / tick_s))),
      forgotten_after_(static_cast<std::uint64_t>(std::llround(kForgottenAfter_s / tick_s))) {
  requireSafe("listen", options_.listen, options_);
  state_.robot_connection = newConnection();
}

void RobotServer::receive() {
  for (int i = 0; i < kMostAtOnce; ++i) {
    const std::optional<UdpPort::Datagram> datagram = port_.receive();
    if (!datagram) {
      return;
    }
    take(*datagram);
  }
}

void RobotServer::take(const UdpPort::Datagram& datagram) {
  const PacketSeal::Opened opened = seal_.open(datagram.bytes);
  if (opened.proof == PacketSeal::Proof::kForged) {
    ++counts_.forged;
    return;
  }
  const std::optional<CommandPacket> packet = parseCommand(opened.packet);
  if (!packet) {
    if (counts_.malformed++ == 0) {
      counts_.first_malformed = describeMalformedCommand(opened.packet);
    }
    return;
  }
  const bool somebody = !operator_.empty() && ticks_ - heard_tick_ < forgotten_after_;
  if (opened.proof == PacketSeal::Proof::kGreeting) {
    ++counts_.greetings;
    operator_ = somebody ? operator_ : datagram.from;  // receives this end's nonce with the next answer
    return;
  }
  const bool another = packet->connection != connection_;
  if (over_.contains(packet->connection) || (!another && packet->number <= number_)) {
    ++counts_.replayed;
    return;
  }
  // A sender that has proved its key may reconnect from any address; others may not take the robot away.
  if (another && connection_ != 0 && somebody && !seal_.hasKey() && datagram.from != operator_) {
    ++counts_.strangers;
    return;
  }
  if (another && connection_ != 0 && over_.size() < kMostOver) {
    over_.insert(connection_);
  }
  ++counts_.taken;
  connection_ = packet->connection;
  number_ = packet->number;
  operator_ = datagram.from;
  heard_tick_ = ticks_;
  state_.operator_connection = connection_;
  state_.sender_time = packet->sender_time;
  if (packet->tare) {
    robot_.tare();
  }
  robot_.take(packet->connection, packet->held, packet->keyframes);
}

void RobotServer::answer() {
  if (ticks_++ % period_ != 0) {
    return;
  }
  const RobotReport report = robot_.report();
  if (state_.reports.empty() || report.index > state_.reports.back().index) {
    state_.reports = history_.add(report);
  } else if (report.index < state_.reports.back().index) {  // another operator counts from the beginning
    history_ = KeyframeHistory<RobotReport>(reportLags(options_.sending.report_keys));
    state_.reports = history_.add(report);
  } else {
    state_.reports.back().pose = report.pose;
  }
  if (operator_.empty()) {
    return;
  }
  state_.at_force_cap = robot_.atForceCap();
  state_.at_speed_cap = robot_.atSpeedCap();
  state_.at_edge = robot_.atWorkspaceEdge();
  state_.newest = robot_.newest();
  state_.state = robot_.state();
  state_.reason = robot_.reason();
  ++state_.number;
  port_.send(operator_, seal_.seal(bytesOf(state_)));
}

void RobotServer::show(SitePacket packet) {
  if (!operator_.empty()) {
    packet.robot_connection = state_.robot_connection;
    port_.send(operator_, seal_.seal(bytesOf(packet)));
  }
}

}  // namespace haptolith

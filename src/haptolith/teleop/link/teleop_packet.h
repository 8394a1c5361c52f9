#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/device/drivers/device_packet.h"
#include "haptolith/teleop/link/command_track.h"
#include "haptolith/teleop/link/link.h"
#include "haptolith/teleop/link/robot_report.h"

namespace haptolith {

/// Command packet of the operator's program, at about 50 Hz: poses of the tool, with keyframes that earlier
/// packets also had, because those may be lost. One UDP packet of 32 + 64 n bytes, little-endian:
///
///     offset  type    what
///          0  u8[4]   "HLTC"
///          4  u16     version, 1
///          6  u16     flags: bit 0 the operator's hand holds the tool; bit 1 the sensor is to find a new zero
///          8  u32     connection: a number that the operator's program has drawn at its start, not 0
///         12  u32     n, keyframes: 1 to 64
///         16  u64     number of this packet, one more with each
///         24  u64     the sender's time, returned in the answer; its unit is the sender's own
///     then n keyframes, the oldest first, of 64 bytes each:
///          0  u64     index of the operator's tick, one a millisecond
///          8  f32[3]  position of the tool's origin, m       site frame; each within 10 m
///         20  f32[4]  orientation, w x y z                   of unit length within 1 %
///         36  f32[3]  velocity, m/s                          each within 100 m/s
///         48  f32[3]  angular velocity, rad/s                each within 1000 rad/s
///         60  f32     opening of jaws, 0 closed to 1 wide open
struct CommandPacket {
  static constexpr std::size_t kHeaderBytes = 32, kKeyframeBytes = 64, kMostKeyframes = 64;
  static constexpr std::uint16_t kVersion = 1;

  bool held = true;
  bool tare = false;
  std::uint32_t connection = 0;
  std::uint64_t number = 0, sender_time = 0;
  std::vector<Keyframe> keyframes = {};
};

/// State packet of the robot, at that rate: executed commands and remote force. One UDP packet of 48 + 72 n bytes,
/// little-endian:
///
///     offset  type    what
///          0  u8[4]   "HLTS"
///          4  u16     version, 1
///          6  u16     flags: bit 0 at its force cap, 1 at its speed cap, 2 at the edge of its workspace
///          8  u32     connection of the operator whose commands it has; 0: none yet
///         12  u32     its own connection: drawn at its start, not 0
///         16  u64     number of this packet, one more with each
///         24  u64     the operator's time in the newest packet that it has had
///         32  u64     index of the newest command that it has had
///         40  u8      RobotState: 0 taring, 1 waiting, 2 approaching, 3 following, 4 holding, 5 retracting, 6 failed
///         41  u8      StopReason: 0 none, 1 silence, 2 released, 3 jump, 4 gap, 5 force, 6 restart, 7 fault
///         42  u16     n, reports: 1 to 64
///         44  u32     0
///     then n reports, the oldest first, of 72 bytes each:
///          0  u64     index of the command that it has come to
///          8  u32     ticks before that index that the wrench is the mean of; 0: it followed no commands
///         12  u32     0
///         16  f32[3]  position of the tool's origin, m       site frame
///         28  f32[4]  orientation, w x y z
///         44  f32[3]  force of the soil on the tool, N
///         56  f32[3]  its torque about the tool's origin, N m
///         68  f32     0
struct StatePacket {
  static constexpr std::size_t kHeaderBytes = 48, kReportBytes = 72, kMostReports = 64;
  static constexpr std::uint16_t kVersion = 1;

  bool at_force_cap = false, at_speed_cap = false, at_edge = false;
  std::uint32_t operator_connection = 0, robot_connection = 0;
  std::uint64_t number = 0, sender_time = 0, newest = 0;
  RobotState state = RobotState::kTaring;
  StopReason reason = StopReason::kNone;
  std::vector<RobotReport> reports = {};
};

/// Reads a packet from any sender; empty when it is malformed: wrong size, magic, version or connection 0, a number
/// that is NaN, infinite or out of range, a turn of no unit length, keyframes or reports that do not grow. Not for the
/// tick.
[[nodiscard]] std::optional<CommandPacket> parseCommand(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::optional<StatePacket> parseState(std::span<const std::uint8_t> bytes);

/// Describes why a robot, or an operator, cannot read a packet, for a message to the author of its sender. Not for the
/// tick.
[[nodiscard]] std::string describeMalformedCommand(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::string describeMalformedReport(std::span<const std::uint8_t> bytes);

/// @throws InvalidParameter for none or more keyframes than a packet holds.
[[nodiscard]] Packet bytesOf(const CommandPacket& packet);
[[nodiscard]] Packet bytesOf(const StatePacket& packet);

/// Entries sent again in case of loss: of one entry per period the newest and some older ones.
template <class Key>
class KeyframeHistory {
 public:
  /// @param lags  in periods, the largest first and 0 last.
  explicit KeyframeHistory(std::vector<std::size_t> lags) : lags_(std::move(lags)) {}

  /// The newest key; what the packet with it holds.
  [[nodiscard]] std::vector<Key> add(const Key& key) {
    keys_.push_front(key);
    if (keys_.size() > lags_.front() + 1) {
      keys_.pop_back();
    }
    std::vector<Key> sent;
    for (const std::size_t lag : lags_) {
      if (lag < keys_.size()) {
        sent.push_back(keys_[lag]);
      }
    }
    return sent;
  }

 private:
  std::vector<std::size_t> lags_;
  std::deque<Key> keys_;  ///< newest first
};

/// Entries of a movement: this number of keyframes in steps that double until they are 0.3 s, between which a hand is
/// smooth. The 13 keyframes of 20 ms, for example, reach back over 2.4 s: 121, 106, ..., 31, 16, 8, 4, 2, 1, 0.
[[nodiscard]] std::vector<std::size_t> commandLags(double period_s, std::size_t keyframes);
/// Which of reports: forces are wanted whole, so 3, 2, 1, 0.
[[nodiscard]] std::vector<std::size_t> reportLags(std::size_t keyframes);

/// Rate and size of packets for a link's rate: 50 Hz, or 10 Hz where that fills four fifths of
/// it with less than 8 keyframes; pictures of the site take a tenth of it at most.
struct Sending {
  double period_s = 0.02;
  std::size_t command_keyframes = 13, report_keys = 4;
  double site_period_s = 0.05;  ///< between two SitePackets
};
[[nodiscard]] Sending sendingOver(const LinkParameters& up, const LinkParameters& down);

}  // namespace haptolith

#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "haptolith/core/platform/udp_socket.h"
#include "haptolith/device/device_parameters.h"
#include "haptolith/device/drivers/device_packet.h"
#include "haptolith/device/drivers/packet_key.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Time limits of a network device.
struct NetworkTimeouts {
  double fresh_s = 0.02;  ///< without a fresh packet for this long the state is stale; 0.001 to 10
  double holder_s = 1;    ///< a sender that is silent for this long has let the tool go; fresh_s to 60
};

/// Counts of received packets by result.
struct NetworkCounts {
  std::uint64_t taken = 0;
  std::array<std::uint64_t, kPacketFaults> malformed{};  ///< by PacketFault
  std::uint64_t late = 0;                                ///< not newer than one taken before, by sequence number
  std::uint64_t others = 0;                              ///< from a sender that does not hold the tool
  std::uint64_t forged = 0;                              ///< with a tag that does not fit the key and the nonce
  std::uint64_t greetings = 0;                           ///< from senders that ask for a nonce
  std::uint64_t unsent = 0;                              ///< answers that the system did not take
  std::uint64_t waited = 0;  ///< taken, but too old to move the tool, as after a pause of this program
};

/// Events that inputWarnings() reports at their first occurrence.
enum class NetworkWarning : std::uint8_t { kMalformed, kForged, kOther, kWaited };
inline constexpr std::size_t kNetworkWarnings = 4;

/// Any other device or program, by UDP: it sends DevicePackets and is sent AnswerPackets, at most one for each, after
/// write(). The first sender holds the tool until it falls silent; then the next one takes it, with whatever sequence
/// number. From a sender that keeps its dead-man switch released as long as that, another takes it who holds his. While
/// its packets are late or its dead-man switch is released the state is stale and the tool stays where it was. A packet
/// is as old as its time in the system's queue: packets that piled up while the program was suspended are not fresh.
///
/// With a key every packet is signed, and senders without it can neither hold the tool nor push the hand. A sender
/// first signs with a nonce of zeros, a greeting, and receives the nonce for all later packets; it changes
/// each time the tool is taken. Without a key it listens to this machine only, unless all users
/// of the network are declared trusted. Nothing is encrypted.
class NetworkDevice final : public HapticDevice {
 public:
  /// Listens at `parameters.address`, an IPv4 address of this machine and a port: "127.0.0.1:9050" when it is empty,
  /// and beyond this machine only if that address is given. Port 0: any free one.
  /// @throws InvalidParameter for an invalid address, one beyond this machine without key or `insecure`, an invalid
  /// key, and timeouts out of range; Failure when it cannot listen.
  explicit NetworkDevice(const DeviceParameters& parameters, const NetworkTimeouts& timeouts = {});
  ~NetworkDevice() override = default;
  NetworkDevice(const NetworkDevice&) = delete;
  NetworkDevice& operator=(const NetworkDevice&) = delete;

  [[nodiscard]] std::string_view name() const noexcept override { return "network device"; }
  /// Those of a sigma.7, whatever is at the other end: a client's word is not trusted.
  [[nodiscard]] DeviceLimits limits() const noexcept override;
  /// The newest of all packets that have come since the last call; at most 256 are looked at.
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const DeviceOutput& output) noexcept override;
  /// Also sends an answer with zero force at once.
  void releaseForce() noexcept override;
  void resumeForce() noexcept override { released_.store(false); }
  [[nodiscard]] std::string_view problem() const noexcept override;
  [[nodiscard]] std::vector<std::string> inputWarnings() const override;
  [[nodiscard]] std::string inputSummary() const override;

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  /// From the loop's thread.
  [[nodiscard]] const NetworkCounts& counts() const noexcept { return counts_; }

 private:
  [[nodiscard]] bool receive(std::int64_t clock_ahead_ns) noexcept;
  void take(std::span<const std::byte> bytes, std::uint64_t sender, std::int64_t came_ns) noexcept;
  void lose(const char* reason) noexcept;
  [[nodiscard]] bool warnedOf(NetworkWarning what) const noexcept;
  void warn(NetworkWarning what) noexcept;
  [[nodiscard]] std::string textOf(NetworkWarning what) const;
  [[nodiscard]] bool mayTake(const DevicePacket& packet, std::uint64_t sender) const noexcept;
  [[nodiscard]] bool isSigned(std::span<const std::byte> bytes, const DevicePacket& packet,
                              std::uint64_t sender) noexcept;
  [[nodiscard]] PacketKey::Nonce holderNonce() const noexcept;
  void release() noexcept;
  [[nodiscard]] bool answer(const DeviceOutput& output) noexcept;
  [[nodiscard]] bool sendTo(std::uint64_t receiver, const AnswerPacket& packet, const PacketKey::Nonce& nonce) noexcept;

  DeviceParameters parameters_;
  UdpSocket socket_;
  std::uint16_t port_ = 0;
  std::int64_t fresh_ns_, holder_ns_;

  // For the loop's thread.
  DeviceInput input_;
  std::int64_t now_ns_ = 0, taken_ns_ = 0;  ///< time of this read(), arrival of the newest packet
  std::int64_t held_ns_ = 0;                ///< when the dead-man switch was held last, or the tool taken
  bool held_ = false;                       ///< the dead-man switch
  int owed_ = 0;                            ///< answers: one for each packet, but no more than wait for a while
  bool zero_owed_ = false;                  ///< one more, since the sender has just fallen silent
  std::optional<PacketKey> key_;
  std::uint64_t epoch_ = 0;  ///< incremented each time the tool is taken or freed
  NetworkCounts counts_;
  std::array<bool, kNetworkWarnings> warned_{};

  // Written once by the loop's thread, before warning_count_ grows.
  std::array<NetworkWarning, kNetworkWarnings> warnings_{};  ///< in order of occurrence
  std::atomic<std::size_t> warning_count_{0};
  PacketFault fault_{};         ///< fault of the first malformed packet
  PacketHead malformed_;        ///< head of that packet
  std::uint64_t other_ = 0;     ///< address of the first other sender
  std::int64_t waited_ns_ = 0;  ///< age of the first packet that was too old

  // Written by the loop's thread, and read by the thread that releases the force.
  std::atomic<std::uint64_t> holder_{0};               ///< IPv4 address and port; 0: free
  std::array<std::atomic<std::uint64_t>, 2> nonce_{};  ///< the holder's
  std::atomic<std::uint64_t> sender_time_{0};
  std::atomic<std::uint32_t> sequence_{0}, answers_{0};
  std::atomic<bool> live_{false}, released_{false}, lost_{false};
  std::array<char, 200> problem_{};
  std::size_t problem_size_ = 0;
};

}  // namespace haptolith

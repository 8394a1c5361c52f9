#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace haptolith {

/// IPv4 address and port.
struct UdpAddress {
  std::uint32_t host = 0;  ///< 127.0.0.1 is 0x7F000001
  std::uint16_t port = 0;

  [[nodiscard]] bool operator==(const UdpAddress&) const = default;
  [[nodiscard]] bool isThisMachine() const noexcept { return host >> 24U == 127; }
  /// "127.0.0.1:9050"
  [[nodiscard]] std::string text() const;
};

/// Reads "127.0.0.1:9050" or "localhost:9050".
[[nodiscard]] std::optional<UdpAddress> udpAddressIn(std::string_view text);

/// Whether a socket with SO_REUSEADDR takes a port away from the program that has it.
#ifdef _WIN32
inline constexpr bool kReuseTakesPortsInUse = true;
#else
inline constexpr bool kReuseTakesPortsInUse = false;
#endif

/// IPv4 address by which other machines reach this one; none without a network. Not for the tick.
[[nodiscard]] std::optional<std::uint32_t> hostForOthers();

/// A socket that receives and sends datagrams and never waits.
class UdpSocket {
 public:
  UdpSocket() = default;
  ~UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  /// Returns 0 or an error number. @param buffer_bytes  for packets that wait
  [[nodiscard]] int open(int buffer_bytes) noexcept;
  /// Returns 0 or an error number. Port 0 chooses a free one.
  [[nodiscard]] int bind(const UdpAddress& address) noexcept;
  /// The port of bind().
  [[nodiscard]] std::uint16_t port() const noexcept;

  enum class Received : std::uint8_t {
    kPacket,
    kNothing,  ///< no packet waits
    kError,    ///< and the socket still works
    kBroken,
  };
  struct Packet {
    std::size_t bytes = 0;
    UdpAddress sender;
    std::optional<std::int64_t> wall_ns;  ///< when it came, by the wall clock, if the system says
    int error = 0;
  };
  /// Puts the next packet that waits into `into`. May be called in the tick.
  [[nodiscard]] Received receive(std::span<std::byte> into, Packet& packet) noexcept;

  /// Whether the system took the packet. May be called in the tick and by handlers of signals; leaves errno as it was.
  [[nodiscard]] bool send(const UdpAddress& to, std::span<const std::byte> bytes) noexcept;

  [[nodiscard]] static bool isInUse(int error) noexcept;
  [[nodiscard]] static const char* reason(int error) noexcept;

 private:
  static constexpr std::intptr_t kNone = -1;
  std::intptr_t socket_ = kNone;
};

}  // namespace haptolith

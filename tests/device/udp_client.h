#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "haptolith/core/platform/child_process.h"
#include "haptolith/device/drivers/device_packet.h"

namespace haptolith {

/// The other end of a network device on this machine.
class UdpClient {
 public:
  explicit UdpClient(std::uint16_t port) : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    EXPECT_EQ(connect(socket_.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }

  void send(std::span<const std::byte> bytes) const {
    EXPECT_EQ(::send(socket_.number(), bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  }
  void send(const DevicePacket& packet) const { send(bytesOf(packet)); }

  /// The next answer; empty when none arrives within `timeout_ms`.
  [[nodiscard]] std::optional<AnswerPacket> receive(int timeout_ms = 0) const {
    const std::vector<std::byte> bytes = receiveBytes(timeout_ms);
    if (bytes.empty()) {
      return std::nullopt;
    }
    const auto answer = parseAnswer(bytes);
    EXPECT_TRUE(answer) << "something that is no answer";
    return answer;
  }

  /// As receive(), whatever it is.
  [[nodiscard]] std::vector<std::byte> receiveBytes(int timeout_ms = 0) const {
    pollfd wanted{socket_.number(), POLLIN, 0};
    if (poll(&wanted, 1, timeout_ms) != 1) {
      return {};
    }
    std::vector<std::byte> bytes(1000);
    const ssize_t size = recv(socket_.number(), bytes.data(), bytes.size(), 0);
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(0, size)));
    return bytes;
  }

 private:
  Descriptor socket_;
};

}  // namespace haptolith

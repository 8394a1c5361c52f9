#include "haptolith/core/platform/udp_socket.h"

#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace haptolith {

namespace {

sockaddr_in systemsAddress(const UdpAddress& address) noexcept {
  sockaddr_in system{};
  system.sin_family = AF_INET;
  system.sin_addr.s_addr = htonl(address.host);
  system.sin_port = htons(address.port);
  return system;
}

// The system's interface takes every kind of address by a pointer to its first member.
// NOLINTBEGIN(cppcoreguidelines-pro-type-reinterpret-cast)
sockaddr* generic(sockaddr_in& address) noexcept {
  return reinterpret_cast<sockaddr*>(&address);
}
const sockaddr* generic(const sockaddr_in& address) noexcept {
  return reinterpret_cast<const sockaddr*>(&address);
}
// NOLINTEND(cppcoreguidelines-pro-type-reinterpret-cast)

/// Errors after which the socket still works.
bool passes(int error) noexcept {
  return error == EINTR || error == ECONNREFUSED || error == ENOBUFS || error == ENOMEM || error == ENETDOWN;
}

std::optional<std::int64_t> stampOf(const msghdr& message) noexcept {
  const cmsghdr* header = CMSG_FIRSTHDR(&message);  // nothing else has been asked for
  if (header == nullptr || header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_TIMESTAMPNS) {
    return std::nullopt;
  }
  timespec stamp{};
  std::memcpy(&stamp, CMSG_DATA(header), sizeof stamp);
  return stamp.tv_sec * 1'000'000'000 + stamp.tv_nsec;
}

}  // namespace

std::optional<std::uint32_t> hostForOthers() {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) {
    return std::nullopt;
  }
  std::optional<std::uint32_t> found;
  for (const ifaddrs* one = all; one != nullptr && !found; one = one->ifa_next) {
    const bool usable = one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET &&
                        (one->ifa_flags & IFF_UP) != 0 && (one->ifa_flags & IFF_LOOPBACK) == 0;
    if (usable) {
      sockaddr_in address{};
      std::memcpy(&address, one->ifa_addr, sizeof address);
      found = ntohl(address.sin_addr.s_addr);
    }
  }
  freeifaddrs(all);
  return found;
}

UdpSocket::~UdpSocket() {
  if (socket_ != kNone) {
    ::close(static_cast<int>(socket_));
  }
}

int UdpSocket::open(int buffer_bytes) noexcept {
  const int number = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (number < 0) {
    return errno;
  }
  socket_ = number;
  setsockopt(number, SOL_SOCKET, SO_RCVBUF, &buffer_bytes, sizeof buffer_bytes);
  constexpr int kYes = 1;
  setsockopt(number, SOL_SOCKET, SO_TIMESTAMPNS, &kYes, sizeof kYes);
  return 0;
}

int UdpSocket::bind(const UdpAddress& address) noexcept {
  const sockaddr_in system = systemsAddress(address);
  return ::bind(static_cast<int>(socket_), generic(system), sizeof system) == 0 ? 0 : errno;
}

std::uint16_t UdpSocket::port() const noexcept {
  sockaddr_in system{};
  socklen_t size = sizeof system;
  getsockname(static_cast<int>(socket_), generic(system), &size);
  return ntohs(system.sin_port);
}

UdpSocket::Received UdpSocket::receive(std::span<std::byte> into, Packet& packet) noexcept {
  alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(timespec))> control;
  sockaddr_in sender{};
  iovec bytes{into.data(), into.size()};
  msghdr message{};
  message.msg_name = &sender;
  message.msg_namelen = sizeof sender;
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t received = recvmsg(static_cast<int>(socket_), &message, 0);
  if (received >= 0) {
    packet.bytes = static_cast<std::size_t>(received);
    packet.sender = {ntohl(sender.sin_addr.s_addr), ntohs(sender.sin_port)};
    packet.wall_ns = stampOf(message);
    return Received::kPacket;
  }
  packet.error = errno;
  return packet.error == EAGAIN ? Received::kNothing : passes(packet.error) ? Received::kError : Received::kBroken;
}

bool UdpSocket::send(const UdpAddress& to, std::span<const std::byte> bytes) noexcept {
  const int error = errno;
  const sockaddr_in system = systemsAddress(to);
  const ssize_t sent =
      sendto(static_cast<int>(socket_), bytes.data(), bytes.size(), MSG_NOSIGNAL, generic(system), sizeof system);
  errno = error;
  return sent == static_cast<ssize_t>(bytes.size());
}

bool UdpSocket::isInUse(int error) noexcept {
  return error == EADDRINUSE;
}

const char* UdpSocket::reason(int error) noexcept {
  return strerrordesc_np(error);
}

}  // namespace haptolith

#include "haptolith/core/platform/udp_socket.h"

// The order matters.
// clang-format off
#include <winsock2.h>
#include <ws2tcpip.h>
#include <iphlpapi.h>
#include <mswsock.h>
// clang-format on

#include <cstddef>
#include <vector>

namespace haptolith {

namespace {

/// Sockets work while it exists, which is for ever.
struct Winsock {
  Winsock() noexcept {
    WSADATA data{};
    error = WSAStartup(MAKEWORD(2, 2), &data);
  }
  int error = 0;
};

sockaddr_in systemsAddress(const UdpAddress& address) noexcept {
  sockaddr_in system{};
  system.sin_family = AF_INET;
  system.sin_addr.s_addr = htonl(address.host);
  system.sin_port = htons(address.port);
  return system;
}

/// Errors after which the socket still works: a receiver that is gone, or a packet that was too long.
bool passes(int error) noexcept {
  return error == WSAECONNRESET || error == WSAENETRESET || error == WSAEMSGSIZE || error == WSAENOBUFS ||
         error == WSAENETDOWN;
}

}  // namespace

std::optional<std::uint32_t> hostForOthers() {
  constexpr ULONG kFlags = GAA_FLAG_SKIP_ANYCAST | GAA_FLAG_SKIP_MULTICAST | GAA_FLAG_SKIP_DNS_SERVER;
  ULONG size = 16384;
  std::vector<std::byte> bytes(size);
  const auto get = [&] {
    return GetAdaptersAddresses(AF_INET, kFlags, nullptr, reinterpret_cast<IP_ADAPTER_ADDRESSES*>(bytes.data()), &size);
  };
  ULONG result = get();
  if (result == ERROR_BUFFER_OVERFLOW) {
    bytes.resize(size);
    result = get();
  }
  if (result != NO_ERROR) {
    return std::nullopt;
  }
  for (auto* one = reinterpret_cast<const IP_ADAPTER_ADDRESSES*>(bytes.data()); one != nullptr; one = one->Next) {
    const auto* address = one->FirstUnicastAddress;
    if (one->OperStatus == IfOperStatusUp && one->IfType != IF_TYPE_SOFTWARE_LOOPBACK && address != nullptr) {
      return ntohl(reinterpret_cast<const sockaddr_in*>(address->Address.lpSockaddr)->sin_addr.s_addr);
    }
  }
  return std::nullopt;
}

UdpSocket::~UdpSocket() {
  if (socket_ != kNone) {
    closesocket(static_cast<SOCKET>(socket_));
  }
}

int UdpSocket::open(int buffer_bytes) noexcept {
  static const Winsock winsock;
  if (winsock.error != 0) {
    return winsock.error;
  }
  const SOCKET made = WSASocketW(AF_INET, SOCK_DGRAM, IPPROTO_UDP, nullptr, 0, WSA_FLAG_NO_HANDLE_INHERIT);
  if (made == INVALID_SOCKET) {
    return WSAGetLastError();
  }
  socket_ = static_cast<std::intptr_t>(made);
  u_long never_waits = 1;
  ioctlsocket(made, static_cast<long>(FIONBIO), &never_waits);
  setsockopt(made, SOL_SOCKET, SO_RCVBUF, reinterpret_cast<const char*>(&buffer_bytes), sizeof buffer_bytes);
  // Without it, a receiver that is gone makes the next call that receives fail.
  BOOL reports = FALSE;
  DWORD ignored = 0;
  WSAIoctl(made, SIO_UDP_CONNRESET, &reports, sizeof reports, nullptr, 0, &ignored, nullptr, nullptr);
  return 0;
}

int UdpSocket::bind(const UdpAddress& address) noexcept {
  const sockaddr_in system = systemsAddress(address);
  const BOOL alone = TRUE;  // else another program could take the port away
  setsockopt(static_cast<SOCKET>(socket_), SOL_SOCKET, SO_EXCLUSIVEADDRUSE, reinterpret_cast<const char*>(&alone),
             sizeof alone);
  return ::bind(static_cast<SOCKET>(socket_), reinterpret_cast<const sockaddr*>(&system), sizeof system) == 0
             ? 0
             : WSAGetLastError();
}

std::uint16_t UdpSocket::port() const noexcept {
  sockaddr_in system{};
  int size = sizeof system;
  getsockname(static_cast<SOCKET>(socket_), reinterpret_cast<sockaddr*>(&system), &size);
  return ntohs(system.sin_port);
}

UdpSocket::Received UdpSocket::receive(std::span<std::byte> into, Packet& packet) noexcept {
  sockaddr_in sender{};
  int size = sizeof sender;
  const int received = recvfrom(static_cast<SOCKET>(socket_), reinterpret_cast<char*>(into.data()),
                                static_cast<int>(into.size()), 0, reinterpret_cast<sockaddr*>(&sender), &size);
  packet.error = received < 0 ? WSAGetLastError() : 0;
  if (received >= 0 || packet.error == WSAEMSGSIZE) {  // too long: what fits has been received
    packet.bytes = received >= 0 ? static_cast<std::size_t>(received) : into.size();
    packet.sender = {ntohl(sender.sin_addr.s_addr), ntohs(sender.sin_port)};
    packet.wall_ns.reset();
    return Received::kPacket;
  }
  return packet.error == WSAEWOULDBLOCK ? Received::kNothing
         : passes(packet.error)         ? Received::kError
                                        : Received::kBroken;
}

bool UdpSocket::send(const UdpAddress& to, std::span<const std::byte> bytes) noexcept {
  const sockaddr_in system = systemsAddress(to);
  return sendto(static_cast<SOCKET>(socket_), reinterpret_cast<const char*>(bytes.data()),
                static_cast<int>(bytes.size()), 0, reinterpret_cast<const sockaddr*>(&system),
                sizeof system) == static_cast<int>(bytes.size());
}

bool UdpSocket::isInUse(int error) noexcept {
  return error == WSAEADDRINUSE || error == WSAEACCES;
}

const char* UdpSocket::reason(int error) noexcept {
  switch (error) {
    case WSAEADDRINUSE:
    case WSAEACCES: return "Address already in use";
    case WSAEADDRNOTAVAIL: return "Cannot assign requested address";
    case WSAEMFILE: return "Too many open files";
    case WSAENOTSOCK: return "The socket is closed";
    default: return "Windows refused it";
  }
}

}  // namespace haptolith

#include "link.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <string>

namespace hand_in_the_loop {

namespace {

std::int64_t clockNs(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

std::runtime_error failure(const char* what) {
  return std::runtime_error(std::string(what) + ": " + std::strerror(errno));
}

sockaddr_in local(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

}  // namespace

std::int64_t monotonicNs() {
  return clockNs(CLOCK_MONOTONIC);
}

// The system's interface accepts all kinds of addresses by a pointer to the first member.
// NOLINTBEGIN(cppcoreguidelines-pro-type-reinterpret-cast)
Link::Link(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  const sockaddr_in address = local(port);
  const int on = 1;
  if (socket_ < 0 || setsockopt(socket_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) != 0 ||
      connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw failure("cannot make a UDP socket");
  }
}

std::uint16_t freePort() {
  const int number = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = local(0);
  socklen_t size = sizeof address;
  if (number < 0 || bind(number, reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      getsockname(number, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw failure("cannot find a free UDP port");
  }
  close(number);
  return ntohs(address.sin_port);
}
// NOLINTEND(cppcoreguidelines-pro-type-reinterpret-cast)

Link::~Link() {
  if (socket_ >= 0) {
    close(socket_);
  }
}

void Link::send(const DevicePacket& packet) {
  const auto bytes = bytesOf(packet);
  // The port may not be open yet, or no more; this is visible in the answers.
  (void)::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

std::optional<Arrival> Link::take() {
  for (;;) {
    std::array<std::byte, Answer::kBytes + 1> bytes{};
    alignas(cmsghdr) std::array<char, 128> control{};
    iovec data{bytes.data(), bytes.size()};
    msghdr message{};
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = recvmsg(socket_, &message, 0);
    if (size < 0) {
      if (errno == EINTR || errno == ECONNREFUSED) {
        continue;  // the latter is reported once for each undelivered packet
      }
      return std::nullopt;
    }
    const auto answer = parseAnswer(std::span(bytes).first(static_cast<std::size_t>(size)));
    if (!answer) {
      continue;
    }
    Arrival arrival{*answer, monotonicNs()};
    for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
      if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == SCM_TIMESTAMPNS) {
        timespec stamp{};
        std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
        const std::int64_t age_ns =
            clockNs(CLOCK_REALTIME) - (std::int64_t{stamp.tv_sec} * 1'000'000'000 + stamp.tv_nsec);
        arrival.at_ns -= age_ns > 0 ? age_ns : 0;
      }
    }
    return arrival;
  }
}

bool Link::wait(int timeout_ms) {
  pollfd waiting{socket_, POLLIN, 0};
  return poll(&waiting, 1, timeout_ms) > 0;
}

}  // namespace hand_in_the_loop

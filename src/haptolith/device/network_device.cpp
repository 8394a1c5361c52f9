#include "haptolith/device/network_device.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <ctime>
#include <optional>

#include "haptolith/core/clock.h"
#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr std::string_view kUsualAddress = "127.0.0.1:9050";
constexpr int kMostPackets = 64;  // that one tick looks at: a flood costs it no more
// Some hundred packets: what a flood leaves waiting is seen to within a few ticks.
constexpr int kReceiveBuffer = 64 * 1024;
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);  // a signal's handler may let go

sockaddr_in addressOf(std::string_view text) {
  const auto refuse = [&] {
    return InvalidParameter("address", fmt::format("'{}'", text),
                            "HOST:PORT with an IPv4 address of this machine, for example 127.0.0.1:9050 for this "
                            "machine alone or 0.0.0.0:9050 for others, too");
  };
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) {
    throw refuse();
  }
  const std::string host(text.substr(0, colon) == "localhost" ? "127.0.0.1" : text.substr(0, colon));
  const std::string_view port = text.substr(colon + 1);
  std::uint16_t number = 0;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(number);
  if (error != std::errc{} || end != port.data() + port.size() ||
      inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) {
    throw refuse();
  }
  return address;
}

std::uint64_t packed(const sockaddr_in& address) noexcept {
  return std::uint64_t{address.sin_addr.s_addr} << 16 | address.sin_port;
}

sockaddr_in unpacked(std::uint64_t sender) noexcept {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = static_cast<std::uint32_t>(sender >> 16);
  address.sin_port = static_cast<std::uint16_t>(sender);
  return address;
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

/// What a socket reports that is still one.
bool passes(int error) noexcept {
  return error == EINTR || error == ECONNREFUSED || error == ENOBUFS || error == ENOMEM || error == ENETDOWN;
}

std::int64_t wallClockNs() noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return now.tv_sec * 1'000'000'000 + now.tv_nsec;
}

/// When the packet came to this machine, by its wall clock in ns.
std::optional<std::int64_t> stampOf(const msghdr& message) noexcept {
  const cmsghdr* header = CMSG_FIRSTHDR(&message);  // nothing else has been asked for
  if (header == nullptr || header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_TIMESTAMPNS) {
    return std::nullopt;
  }
  timespec stamp{};
  std::memcpy(&stamp, CMSG_DATA(header), sizeof stamp);
  return stamp.tv_sec * 1'000'000'000 + stamp.tv_nsec;
}

std::int64_t nanoseconds(double seconds) {
  return std::llround(seconds * 1e9);
}

}  // namespace

NetworkDevice::NetworkDevice(const DeviceParameters& parameters, const NetworkPatience& patience)
    : fresh_ns_(nanoseconds(requireInRange("fresh_s", patience.fresh_s, {0.001, 10}))),
      holder_ns_(nanoseconds(requireInRange("holder_s", patience.holder_s, {patience.fresh_s, 60}))) {
  const std::string text(parameters.address.empty() ? kUsualAddress : std::string_view(parameters.address));
  sockaddr_in address = addressOf(text);
  const auto fail = [&](const char* remedy) {
    return Failure(fmt::format("cannot listen for UDP packets at {}: {}; {}", text, strerrordesc_np(errno), remedy));
  };
  const int number = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (number < 0) {
    throw fail("end programs that hold many sockets");
  }
  socket_ = Descriptor(number);
  setsockopt(number, SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
  constexpr int kYes = 1;
  setsockopt(number, SOL_SOCKET, SO_TIMESTAMPNS, &kYes, sizeof kYes);
  if (bind(number, generic(address), sizeof address) != 0) {
    throw fail(errno == EADDRINUSE ? "end the program that listens there, or choose another port"
                                   : "choose an address of this machine (ip -4 addr) and a port above 1023");
  }
  socklen_t size = sizeof address;
  getsockname(number, generic(address), &size);
  port_ = ntohs(address.sin_port);
  input_.state = DeviceState::kStale;
}

DeviceLimits NetworkDevice::limits() const noexcept {
  constexpr double kFullForceIn_s = 0.003;
  DeviceLimits limits;
  limits.max_force_n = 12;
  limits.max_torque_nm = 0.2;
  limits.max_gripper_force_n = 8;
  limits.grips = true;
  limits.max_force_rate_n_s = limits.max_force_n / kFullForceIn_s;
  limits.max_torque_rate_nm_s = limits.max_torque_nm / kFullForceIn_s;
  limits.max_gripper_rate_n_s = limits.max_gripper_force_n / kFullForceIn_s;
  return limits;
}

DeviceInput NetworkDevice::read() noexcept {
  if (lost_.load(std::memory_order_relaxed)) {
    return input_;
  }
  now_ns_ = monotonicNs();
  const std::int64_t clock_ahead_ns = wallClockNs() - now_ns_;
  for (int i = 0; i < kMostPackets && receive(clock_ahead_ns); ++i) {
  }
  if (lost_.load(std::memory_order_relaxed)) {
    return input_;
  }
  if (now_ns_ - taken_ns_ > holder_ns_) {
    holder_.store(0);
  }
  const bool live = holder_.load() != 0 && held_ && now_ns_ - taken_ns_ <= fresh_ns_;
  live_.store(live);
  input_.state = live ? DeviceState::kLive : DeviceState::kStale;
  if (!live) {
    input_.twist = {};
  }
  return input_;
}

/// Takes the next packet that waits. False when none does, or when the socket is broken.
/// @param clock_ahead_ns  of the wall clock before the monotonic one, now.
bool NetworkDevice::receive(std::int64_t clock_ahead_ns) noexcept {
  std::array<std::byte, DevicePacket::kBytes + 1> bytes;  // one more: a packet that is too long is seen to be
  alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(timespec))> control;
  sockaddr_in sender{};
  iovec into{bytes.data(), bytes.size()};
  msghdr message{};
  message.msg_name = &sender;
  message.msg_namelen = sizeof sender;
  message.msg_iov = &into;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t received = recvmsg(socket_.number(), &message, 0);
  if (received >= 0) {
    // Stamps are of the wall clock. Set forward between packet and read() it makes the packet too old, which is
    // harmless; set back, it makes it new, as it would be without a stamp.
    const std::int64_t came_ns = stampOf(message).value_or(now_ns_ + clock_ahead_ns) - clock_ahead_ns;
    take(std::span(bytes).first(static_cast<std::size_t>(received)), packed(sender), std::min(came_ns, now_ns_));
    return true;
  }
  if (errno == EAGAIN) {
    return false;
  }
  if (!passes(errno)) {
    lose(strerrordesc_np(errno));
    return false;
  }
  return true;
}

void NetworkDevice::take(std::span<const std::byte> bytes, std::uint64_t sender, std::int64_t came_ns) noexcept {
  PacketFault fault{};
  const std::optional<DevicePacket> packet = parse(bytes, &fault);
  if (!packet) {
    ++counts_.malformed[static_cast<std::size_t>(fault)];
    return;
  }
  std::uint64_t holder = holder_.load();
  if (holder != 0 && now_ns_ - taken_ns_ > holder_ns_) {
    holder = 0;
  }
  if (holder != 0 && holder != sender) {
    ++counts_.others;
    return;
  }
  // Newer by less than half of all numbers: right also when they begin again at 0.
  if (holder != 0 && static_cast<std::int32_t>(packet->sequence - sequence_.load()) <= 0) {
    ++counts_.late;
    return;
  }
  ++counts_.taken;
  taken_ns_ = std::max(taken_ns_, came_ns);
  sequence_.store(packet->sequence);
  sender_time_.store(packet->sender_time);
  holder_.store(sender);
  held_ = packet->held;
  if (held_) {
    input_.pose = packet->pose;
    input_.twist = packet->twist;
    input_.gripper_open = packet->gripper_open;
    input_.buttons = packet->buttons;
  }
}

void NetworkDevice::write(const DeviceOutput& output) noexcept {
  const bool let_go = let_go_.load();
  if (!answer(let_go ? DeviceOutput{} : output)) {
    ++counts_.unsent;
  }
  if (!let_go && let_go_.load()) {  // letGo() came in between: its answer must not be followed by one with a force
    (void)answer({});
  }
}

void NetworkDevice::letGo() noexcept {
  let_go_.store(true);
  const int error = errno;  // a signal's handler leaves it as it was
  (void)answer({});
  errno = error;
}

bool NetworkDevice::answer(const DeviceOutput& output) noexcept {
  const std::uint64_t holder = holder_.load();
  if (holder == 0) {
    return true;
  }
  AnswerPacket packet;
  packet.live = live_.load();
  packet.let_go = let_go_.load();
  packet.sequence = sequence_.load();
  packet.number = answers_.fetch_add(1);
  packet.sender_time = sender_time_.load();
  packet.output = output;
  const auto bytes = bytesOf(packet);
  const sockaddr_in address = unpacked(holder);
  return sendto(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL, generic(address), sizeof address) ==
         static_cast<ssize_t>(bytes.size());
}

void NetworkDevice::lose(const char* reason) noexcept {
  const auto end =
      fmt::format_to_n(problem_.data(), problem_.size(),
                       "the network device cannot receive at port {} any more: {}; start the run anew", port_, reason);
  problem_size_ = std::min(end.size, problem_.size());
  input_.state = DeviceState::kLost;
  input_.twist = {};
  live_.store(false);
  lost_.store(true);
}

std::string_view NetworkDevice::problem() const noexcept {
  return lost_.load() ? std::string_view(problem_.data(), problem_size_) : std::string_view{};
}

}  // namespace haptolith

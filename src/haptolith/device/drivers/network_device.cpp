#include "haptolith/device/drivers/network_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"

namespace haptolith {

namespace {

constexpr std::string_view kNetworkAddress = "127.0.0.1:9050";
// The buffer holds about 160 packets, and each tick reads all that wait: packets left by a flood would be
// old in the next one. This number costs a tick 0.17 ms; 0.36 ms with a key, while the tool is free and all have to be
// checked.
constexpr int kMostPackets = 256;
constexpr int kReceiveBuffer = 64 * 1024;
// That a sender is owed at most, when its packets came together: those of the 20 ms in which it is believed.
constexpr int kMostOwed = 20;
constexpr std::size_t kLongestPacket = DevicePacket::kBytes + PacketKey::kTagBytes;
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);  // a signal's handler may release the tool

UdpAddress socketAddressOf(std::string_view text) {
  if (const std::optional<UdpAddress> address = udpAddressIn(text)) {
    return *address;
  }
  throw InvalidParameter("address", fmt::format("'{}'", text),
                         "HOST:PORT with an IPv4 address of this machine, for example 127.0.0.1:9050 for this "
                         "machine only or 0.0.0.0:9050 for all machines");
}

/// An address in one number, which may be atomic. 0: none.
std::uint64_t packed(const UdpAddress& address) noexcept {
  return std::uint64_t{address.host} << 16U | address.port;
}

UdpAddress unpacked(std::uint64_t sender) noexcept {
  return {static_cast<std::uint32_t>(sender >> 16U), static_cast<std::uint16_t>(sender)};
}

std::int64_t nanoseconds(double seconds) {
  return std::llround(seconds * 1e9);
}

}  // namespace

NetworkDevice::NetworkDevice(const DeviceParameters& parameters, const NetworkTimeouts& timeouts)
    : parameters_(parameters),
      fresh_ns_(nanoseconds(requireInRange("fresh_s", timeouts.fresh_s, {0.001, 10}))),
      holder_ns_(nanoseconds(requireInRange("holder_s", timeouts.holder_s, {timeouts.fresh_s, 60}))) {
  const std::string text(parameters.address.empty() ? kNetworkAddress : std::string_view(parameters.address));
  const UdpAddress address = socketAddressOf(text);
  if (!parameters.key.empty()) {
    key_.emplace(parameters.key);
  } else if (!address.isThisMachine() && !parameters.insecure) {
    throw InvalidParameter(
        "address", fmt::format("'{}'", text),
        "one of this machine only, such as 127.0.0.1:9050, unless packets are signed (--device-key-file, "
        "docs/reference/udp.md) or all users of the network are trusted (--device-insecure)");
  }
  const auto fail = [&](int error, const char* remedy) {
    return Failure(fmt::format("cannot listen for UDP packets at {}: {}; {}", text, UdpSocket::reason(error), remedy));
  };
  if (const int error = socket_.open(kReceiveBuffer); error != 0) {
    throw fail(error, "end programs that hold many sockets");
  }
  if (const int error = socket_.bind(address); error != 0) {
    throw fail(error, UdpSocket::isInUse(error)
                          ? "end the program that listens there, or choose another port"
                          : "choose an address of this machine (ip -4 addr) and a port above 1023");
  }
  port_ = socket_.port();
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
  // The device behind the socket is unknown: conservative values until its owner has measured it.
  limits.delay_s = 0.01;
  limits.delay_known = false;
  limits.resolution_m = 1e-4;
  return measured(limits, parameters_);
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
  if (holder_.load() != 0 && now_ns_ - taken_ns_ > holder_ns_) {
    release();
  }
  const bool live = holder_.load() != 0 && held_ && now_ns_ - taken_ns_ <= fresh_ns_;
  zero_owed_ = zero_owed_ || (live_.load() && !live);
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
  std::array<std::byte, kLongestPacket + 1> bytes;  // one more: a packet that is too long is seen to be
  UdpSocket::Packet packet;
  switch (socket_.receive(bytes, packet)) {
    case UdpSocket::Received::kPacket: break;
    case UdpSocket::Received::kNothing: return false;
    case UdpSocket::Received::kError: return true;
    case UdpSocket::Received::kBroken: lose(UdpSocket::reason(packet.error)); return false;
  }
  // Stamps are of the wall clock. Set forward between packet and read() it makes the packet too old, which is
  // harmless; set back, it makes it new, as it would be without a stamp.
  const std::int64_t came_ns = packet.wall_ns.value_or(now_ns_ + clock_ahead_ns) - clock_ahead_ns;
  take(std::span(bytes).first(packet.bytes), packed(packet.sender), std::min(came_ns, now_ns_));
  return true;
}

void NetworkDevice::take(std::span<const std::byte> bytes, std::uint64_t sender, std::int64_t came_ns) noexcept {
  PacketFault fault = PacketFault::kSize;
  const std::size_t size = DevicePacket::kBytes + (key_ ? PacketKey::kTagBytes : 0);
  const std::optional<DevicePacket> packet =
      bytes.size() == size ? parse(bytes.first(DevicePacket::kBytes), &fault) : std::nullopt;
  if (!packet) {
    ++counts_.malformed[static_cast<std::size_t>(fault)];
    if (!warnedOf(NetworkWarning::kMalformed)) {
      fault_ = fault;
      malformed_ = PacketHead(bytes);
      warn(NetworkWarning::kMalformed);
    }
    return;
  }
  if (holder_.load() != 0 && now_ns_ - taken_ns_ > holder_ns_) {
    release();
  }
  if (!mayTake(*packet, sender)) {
    ++counts_.others;
    if (!warnedOf(NetworkWarning::kOther)) {
      other_ = sender;
      warn(NetworkWarning::kOther);
    }
    return;
  }
  // Newer by less than half of all numbers: right also when they begin again at 0.
  const bool newcomer = holder_.load() != sender;
  if (!newcomer && static_cast<std::int32_t>(packet->sequence - sequence_.load()) <= 0) {
    ++counts_.late;
    return;
  }
  if (key_ && !isSigned(bytes, *packet, sender)) {
    return;
  }
  if (newcomer) {
    if (key_) {
      const auto nonce = std::bit_cast<std::array<std::uint64_t, 2>>(key_->nonceFor(sender, epoch_));
      nonce_[0].store(nonce[0]);
      nonce_[1].store(nonce[1]);
    }
    ++epoch_;
    owed_ = 0;
    held_ns_ = came_ns;
    taken_ns_ = came_ns;
  }
  ++counts_.taken;
  if (now_ns_ - came_ns > fresh_ns_) {
    ++counts_.waited;
    if (!warnedOf(NetworkWarning::kWaited)) {
      waited_ns_ = now_ns_ - came_ns;
      warn(NetworkWarning::kWaited);
    }
  }
  taken_ns_ = std::max(taken_ns_, came_ns);
  owed_ = std::min(owed_ + 1, kMostOwed);
  sequence_.store(packet->sequence);
  sender_time_.store(packet->sender_time);
  holder_.store(sender);
  held_ = packet->held;
  if (held_) {
    held_ns_ = taken_ns_;
    input_.pose = packet->pose;
    input_.twist = packet->twist;
    input_.gripper_open = packet->gripper_open;
    input_.buttons = packet->buttons;
  }
}

/// Whether the sender holds the tool, or may take it: the tool is free, or its holder has given it up.
bool NetworkDevice::mayTake(const DevicePacket& packet, std::uint64_t sender) const noexcept {
  const std::uint64_t holder = holder_.load();
  return holder == 0 || holder == sender || (packet.held && !held_ && now_ns_ - held_ns_ > holder_ns_);
}

/// Whether the packet is signed with the sender's nonce. To one that is signed with a nonce of zeros the answer is
/// which.
bool NetworkDevice::isSigned(std::span<const std::byte> bytes, const DevicePacket& packet,
                             std::uint64_t sender) noexcept {
  const auto body = bytes.first(DevicePacket::kBytes);
  const auto tag = bytes.subspan(DevicePacket::kBytes);
  const bool newcomer = holder_.load() != sender;
  const PacketKey::Nonce nonce = newcomer ? key_->nonceFor(sender, epoch_) : holderNonce();
  if (key_->signs(tag, body, nonce)) {
    return true;
  }
  if (!newcomer || !key_->signs(tag, body, {})) {
    ++counts_.forged;
    warn(NetworkWarning::kForged);
    return false;
  }
  ++counts_.greetings;
  AnswerPacket answer;
  answer.sequence = packet.sequence;
  answer.sender_time = packet.sender_time;
  answer.number = answers_.fetch_add(1);
  (void)sendTo(sender, answer, nonce);
  return false;
}

PacketKey::Nonce NetworkDevice::holderNonce() const noexcept {
  return std::bit_cast<PacketKey::Nonce>(std::array{nonce_[0].load(), nonce_[1].load()});
}

/// Frees the tool.
void NetworkDevice::release() noexcept {
  holder_.store(0);
  held_ = false;
  owed_ = 0;
  ++epoch_;
}

void NetworkDevice::write(const DeviceOutput& output) noexcept {
  const bool released = released_.load();
  if (owed_ > 0 || zero_owed_) {  // otherwise one forged packet could flood a third party
    owed_ = std::max(0, owed_ - 1);
    zero_owed_ = false;
    if (!answer(released ? DeviceOutput{} : output)) {
      ++counts_.unsent;
    }
  }
  if (!released &&
      released_.load()) {  // releaseForce() came in between: its answer must not be followed by one with a force
    (void)answer({});
  }
}

void NetworkDevice::releaseForce() noexcept {
  released_.store(true);
  (void)answer({});
}

bool NetworkDevice::answer(const DeviceOutput& output) noexcept {
  const std::uint64_t holder = holder_.load();
  if (holder == 0) {
    return true;
  }
  AnswerPacket packet;
  packet.live = live_.load();
  packet.let_go = released_.load();
  packet.sequence = sequence_.load();
  packet.number = answers_.fetch_add(1);
  packet.sender_time = sender_time_.load();
  packet.output = output;
  return sendTo(holder, packet, holderNonce());
}

bool NetworkDevice::sendTo(std::uint64_t receiver, const AnswerPacket& packet, const PacketKey::Nonce& nonce) noexcept {
  std::array<std::byte, AnswerPacket::kBytes + sizeof nonce + PacketKey::kTagBytes> bytes;
  std::size_t size = AnswerPacket::kBytes;
  std::ranges::copy(bytesOf(packet), bytes.begin());
  if (key_) {
    std::ranges::copy(nonce, bytes.begin() + AnswerPacket::kBytes);
    std::ranges::copy(key_->tagOf(std::span(bytes).first(size + nonce.size()), {}),
                      bytes.begin() + AnswerPacket::kBytes + nonce.size());
    size = bytes.size();
  }
  return socket_.send(unpacked(receiver), std::span(bytes).first(size));
}

void NetworkDevice::lose(const char* reason) noexcept {
  const auto end =
      fmt::format_to_n(problem_.data(), problem_.size(),
                       "the network device cannot receive at port {}: {}; start the run again", port_, reason);
  problem_size_ = std::min(end.size, problem_.size());
  input_.state = DeviceState::kLost;
  input_.twist = {};
  live_.store(false);
  lost_.store(true);
}

bool NetworkDevice::warnedOf(NetworkWarning what) const noexcept {
  return warned_[static_cast<std::size_t>(what)];
}

/// Publishes a warning whose details have been written.
void NetworkDevice::warn(NetworkWarning what) noexcept {
  if (!warnedOf(what)) {
    warned_[static_cast<std::size_t>(what)] = true;
    const std::size_t count = warning_count_.load(std::memory_order_relaxed);
    warnings_[count] = what;
    warning_count_.store(count + 1, std::memory_order_release);
  }
}

std::string NetworkDevice::textOf(NetworkWarning what) const {
  switch (what) {
    case NetworkWarning::kMalformed:
      return fmt::format("malformed packet ignored: {}; see docs/reference/udp.md",
                         describe(fault_, malformed_, key_.has_value()));
    case NetworkWarning::kForged:
      return "packet ignored: its signature does not fit this program's key; use the same key on both ends";
    case NetworkWarning::kOther:
      return fmt::format("packets of a second sender, {}, are ignored until the first is silent for {:g} s",
                         unpacked(other_).text(), 1e-9 * static_cast<double>(holder_ns_));
    case NetworkWarning::kWaited:
      return fmt::format(
          "packets waited {:.0f} ms before they were read, as after a pause of this program; they do not "
          "move the tool",
          1e-6 * static_cast<double>(waited_ns_));
  }
  return "";
}

std::vector<std::string> NetworkDevice::inputWarnings() const {
  std::vector<std::string> all;
  const std::size_t count = warning_count_.load(std::memory_order_acquire);
  for (const NetworkWarning what : std::span(warnings_).first(count)) {
    all.push_back(textOf(what));
  }
  return all;
}

std::string NetworkDevice::inputSummary() const {
  const std::array<std::string_view, kPacketFaults> faults{
      "with wrong size",      "in another format",           "in another version",
      "with NaN or infinity", "with an invalid orientation", "out of range"};
  std::string text = fmt::format("{} taken", counts_.taken);
  const auto add = [&text](std::uint64_t count, std::string_view what) {
    if (count > 0) {
      text += fmt::format(", {} {}", count, what);
    }
  };
  add(counts_.waited, "too old to move the tool");
  for (std::size_t i = 0; i < kPacketFaults; ++i) {
    add(counts_.malformed[i], faults[i]);
  }
  add(counts_.late, "late or repeated");
  add(counts_.others, "from other senders");
  add(counts_.forged, "forged");
  add(counts_.unsent, "replies not sent");
  return text;
}

std::string_view NetworkDevice::problem() const noexcept {
  return lost_.load() ? std::string_view(problem_.data(), problem_size_) : std::string_view{};
}

}  // namespace haptolith

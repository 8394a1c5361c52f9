// A driver's read() and write() allocate nothing in the loop's thread.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/device/drivers/inverse3.h"
#include "haptolith/device/drivers/network_device.h"

#include "../counted_new.h"
#include "haply_service.h"
#include "udp_client.h"

namespace haptolith {
namespace {

TEST(DeviceAllocation, TheCounterCounts) {
  const long before = allocations_of_thread;
  const std::vector<int> some(100);
  EXPECT_EQ(some.size(), 100U);
  EXPECT_GT(allocations_of_thread, before);
}

TEST(DeviceAllocation, ANetworkDeviceAllocatesNothing) {
  DeviceParameters parameters;
  parameters.address = "127.0.0.1:0";
  NetworkDevice device(parameters, {.fresh_s = 10, .holder_s = 60});
  const UdpClient client(device.port());
  const UdpClient other(device.port());
  DevicePacket packet;
  packet.held = true;
  long during = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    ++packet.sequence;
    client.send(packet);
    other.send(packet);
    const auto bytes = bytesOf(packet);
    client.send(std::span(bytes).first(tick % 100));
    const long before = allocations_of_thread;
    (void)device.read();
    device.write({{Vec3(1, 2, 3), Vec3::Zero()}});
    if (tick == 900) {
      device.releaseForce();
    }
    during += allocations_of_thread - before;
    while (client.receive()) {
    }
  }
  EXPECT_EQ(during, 0);
  EXPECT_GT(device.counts().taken, 900U);
  EXPECT_GT(device.counts().others, 900U);
}

TEST(DeviceAllocation, ANetworkDeviceWithAKeyAllocatesNothing) {
  DeviceParameters parameters;
  parameters.address = "127.0.0.1:0";
  parameters.key = std::string(64, '7');
  NetworkDevice device(parameters, {.fresh_s = 10, .holder_s = 60});
  const PacketKey key(parameters.key);
  const UdpClient client(device.port());
  PacketKey::Nonce nonce{};
  DevicePacket packet;
  packet.held = true;
  long during = 0;
  for (int tick = 0; tick < 500; ++tick) {
    ++packet.sequence;
    const auto body = bytesOf(packet);
    std::vector<std::byte> bytes(DevicePacket::kBytes + PacketKey::kTagBytes);
    std::ranges::copy(body, bytes.begin());
    std::ranges::copy(key.tagOf(body, nonce), bytes.begin() + DevicePacket::kBytes);
    client.send(bytes);
    bytes.back() ^= std::byte{1};
    client.send(bytes);
    const long before = allocations_of_thread;
    (void)device.read();
    device.write({{Vec3(1, 2, 3), Vec3::Zero()}});
    if (tick == 400) {
      device.releaseForce();
    }
    during += allocations_of_thread - before;
    for (std::vector<std::byte> answer = client.receiveBytes(); !answer.empty(); answer = client.receiveBytes()) {
      std::ranges::copy(std::span(answer).subspan(80, 16), nonce.begin());
    }
  }
  EXPECT_EQ(during, 0);
  EXPECT_GT(device.counts().taken, 400U);
  EXPECT_GT(device.counts().forged + device.counts().late, 400U);
}

TEST(DeviceAllocation, AnInverse3AllocatesNothingInTheLoopsThread) {
  const HaplyService service({});
  DeviceParameters parameters;
  parameters.address = service.address();
  Inverse3 device(parameters);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  const long before = allocations_of_thread;
  while (service.commands() < 100 && std::chrono::steady_clock::now() < end) {
    (void)device.read();
    device.write({{Vec3(1, 2, 3), Vec3::Zero()}});
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  device.releaseForce();
  EXPECT_EQ(allocations_of_thread, before);
  EXPECT_GE(service.commands(), 100);
}

}  // namespace
}  // namespace haptolith

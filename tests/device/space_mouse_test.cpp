// A SpaceMouse with a mock of the daemon, which listens at a socket and speaks spacenavd's protocol.
#include "haptolith/device/drivers/space_mouse.h"

#include <gmock/gmock.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <thread>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/child_process.h"

#include "allocations.h"
#include "eventually.h"

// libspnav 1.0 forgets some bytes whenever it finds no daemon.
extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions();  // NOLINT: the sanitizer's name
extern "C" const char* __lsan_default_suppressions() {
  return "leak:spnav_open";
}

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kTick_s = 1e-3;

// The protocol, from spacenavd 1.1's src/proto.h: eight numbers for an event, a request and its answer.
using Message = std::array<std::int32_t, 8>;
constexpr std::int32_t kMotion = 0;
constexpr std::int32_t kPress = 1;
constexpr std::int32_t kRelease = 2;
constexpr std::int32_t kDevice = 3;
constexpr std::int32_t kAdded = 0;
constexpr std::int32_t kRemoved = 1;
constexpr std::int32_t kRequestTag = 0x7faa0000;
constexpr std::int32_t kChangeProtocol = kRequestTag | 0x5500;
constexpr std::int32_t kDeviceType = kRequestTag | 0x2005;
constexpr std::int32_t kSpaceMousePro = 0x20a;

/// spacenavd, for one client at a time.
class PlayedDaemon {
 public:
  explicit PlayedDaemon(bool has_puck = true) : has_puck_(has_puck) {
    std::string folder = (std::filesystem::temp_directory_path() / "haptolith-spnav-XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr) {
      throw std::runtime_error("no temporary folder");
    }
    folder_ = folder;
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = (folder_ / "spnav.sock").string();
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    if (bind(listener_.number(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
        listen(listener_.number(), 1) != 0) {
      throw std::runtime_error("cannot listen at " + path);
    }
    setenv("SPNAV_SOCKET", path.c_str(), 1);
    thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  }
  ~PlayedDaemon() {
    unsetenv("SPNAV_SOCKET");
    thread_ = {};
    std::filesystem::remove_all(folder_);
  }
  PlayedDaemon(const PlayedDaemon&) = delete;
  PlayedDaemon& operator=(const PlayedDaemon&) = delete;

  /// To the client that is there.
  void send(const Message& message) {
    ASSERT_TRUE(eventually([&] { return client_ >= 0; }));
    ASSERT_EQ(::send(client_, message.data(), sizeof message, MSG_NOSIGNAL), static_cast<ssize_t>(sizeof message));
  }

 private:
  void serve(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      if (!readable(listener_.number())) {
        continue;
      }
      const Descriptor client(accept(listener_.number(), nullptr, nullptr));
      bool greeted = false;
      while (!stop.stop_requested()) {
        if (!readable(client.number())) {
          continue;
        }
        Message request{};
        const std::size_t bytes = greeted ? sizeof request : sizeof request[0];
        if (recv(client.number(), request.data(), bytes, MSG_WAITALL) <= 0) {
          break;
        }
        if (!greeted) {
          greeted = (request[0] & ~0xFF) == kChangeProtocol;
          client_ = client.number();
        } else if (request[0] == kDeviceType) {
          request[1] = kSpaceMousePro;
          request[7] = has_puck_ ? 0 : -1;
        }
        (void)::send(client.number(), request.data(), bytes, MSG_NOSIGNAL);
      }
      client_ = -1;
    }
  }

  static bool readable(int descriptor) {
    pollfd wanted{.fd = descriptor, .events = POLLIN, .revents = 0};
    return poll(&wanted, 1, 5) > 0;
  }

  bool has_puck_;
  std::filesystem::path folder_;
  Descriptor listener_{socket(AF_UNIX, SOCK_STREAM, 0)};
  std::atomic<int> client_{-1};
  std::jthread thread_;
};

Message motion(const PuckCounts& counts) {
  return {kMotion, counts.x, counts.y, counts.z, counts.rx, counts.ry, counts.rz, 16};
}

constexpr int kFull = static_cast<int>(SpaceMouse::kFullDeflection);

TEST(DeflectionOf, PutsUpUpAndAwayAway) {
  const auto is = [](const PuckCounts& counts, const Vec3& linear, const Vec3& angular) {
    const Deflection deflection = deflectionOf(counts);
    EXPECT_EQ(deflection.linear, linear);
    EXPECT_EQ(deflection.angular, angular);
  };
  const Vec3 none = Vec3::Zero();
  is({.x = kFull}, Vec3::UnitX(), none);
  is({.y = kFull}, Vec3::UnitZ(), none);
  is({.z = kFull}, Vec3::UnitY(), none);
  is({.rx = kFull}, none, Vec3::UnitX());
  is({.ry = kFull}, none, Vec3::UnitZ());
  is({.rz = kFull}, none, Vec3::UnitY());
}

TEST(DeflectionOf, IsFiniteForEveryCount) {
  constexpr int kLowest = std::numeric_limits<int>::lowest();
  const Deflection deflection = deflectionOf({kLowest, kLowest, kLowest, kLowest, kLowest, kLowest});
  EXPECT_TRUE(rateOf(deflection, {}).linear_m_s.allFinite());
  EXPECT_NEAR(rateOf(deflection, {}).linear_m_s.norm(), RateParameters{}.max_speed_m_s, 1e-12);
}

class SpaceMouseTest : public testing::Test {
 protected:
  SpaceMouseTest() { std::signal(SIGPIPE, SIG_IGN); }  // as the program has it

  std::optional<PlayedDaemon> daemon_{std::in_place};
};

TEST_F(SpaceMouseTest, MovesAndTurnsAsItIsPushedAndRestsWhenItIsLetGo) {
  SpaceMouse mouse({}, kTick_s);
  EXPECT_EQ(mouse.read().pose.position_m, Vec3::Zero());
  EXPECT_EQ(mouse.read().state, DeviceState::kLive);

  daemon_->send(motion({.z = kFull}));
  EXPECT_TRUE(eventually([&] { return mouse.read().twist.linear_m_s.isApprox(Vec3(0, 0.15, 0), 0.01); }));
  daemon_->send(motion({.ry = -kFull}));
  EXPECT_TRUE(eventually([&] { return mouse.read().twist.angular_rad_s.isApprox(Vec3(0, 0, -1.5), 0.01); }));
  daemon_->send(motion({}));
  EXPECT_TRUE(eventually([&] {
    const DeviceInput input = mouse.read();
    return input.twist.linear_m_s.norm() == 0 && input.twist.angular_rad_s.norm() == 0;
  }));
  EXPECT_GT(mouse.read().pose.position_m.y(), 0);
}

TEST_F(SpaceMouseTest, ASilentPushGoesOn) {
  SpaceMouse mouse({}, kTick_s);
  daemon_->send(motion({.x = kFull}));
  ASSERT_TRUE(eventually([&] { return mouse.read().twist.linear_m_s.x() > 0.14; }));
  for (int i = 0; i < 5000; ++i) {
    (void)mouse.read();
  }
  EXPECT_NEAR(mouse.read().pose.position_m.x(), mouse.limits().workspace_radius_m, 1e-9);
  EXPECT_EQ(mouse.read().state, DeviceState::kLive);
}

TEST_F(SpaceMouseTest, PassesButtonsOnByTheirNumbers) {
  SpaceMouse mouse({}, kTick_s);
  daemon_->send({kPress, 0});
  daemon_->send({kPress, 31});
  EXPECT_TRUE(eventually([&] { return mouse.read().buttons == 0x80000001; }));
  daemon_->send({kRelease, 0});
  EXPECT_TRUE(eventually([&] { return mouse.read().buttons == 0x80000000; }));
}

TEST_F(SpaceMouseTest, IsLostAndStandsStillWhenTheDaemonEnds) {
  SpaceMouse mouse({}, kTick_s);
  EXPECT_EQ(mouse.problem(), "");
  daemon_->send(motion({.x = kFull}));
  daemon_->send({kPress, 1});
  ASSERT_TRUE(eventually([&] { return mouse.read().buttons == 2; }));
  daemon_.reset();
  ASSERT_TRUE(eventually([&] { return mouse.read().state == DeviceState::kLost; }));
  EXPECT_THAT(std::string(mouse.problem()), HasSubstr("spacenavd, has ended: sudo systemctl start spacenavd"));
  EXPECT_EQ(mouse.read().buttons, 0U);
  EXPECT_TRUE(eventually([&] { return mouse.read().twist.linear_m_s.norm() == 0; }));
}

TEST_F(SpaceMouseTest, IsStaleWhenItIsUnpluggedAndComesBack) {
  SpaceMouse mouse({}, kTick_s);
  daemon_->send(motion({.x = kFull}));
  ASSERT_TRUE(eventually([&] { return mouse.read().twist.linear_m_s.x() > 0.1; }));
  daemon_->send({kDevice, kRemoved});
  ASSERT_TRUE(eventually([&] { return mouse.read().state == DeviceState::kStale; }));
  EXPECT_THAT(std::string(mouse.problem()), HasSubstr("unplugged: plug it in to continue"));
  EXPECT_TRUE(eventually([&] { return mouse.read().twist.linear_m_s.norm() == 0; }));
  daemon_->send({kDevice, kAdded});
  EXPECT_TRUE(eventually([&] { return mouse.read().state == DeviceState::kLive; }));
  EXPECT_EQ(mouse.problem(), "");
}

TEST_F(SpaceMouseTest, RubbishFromTheDaemonDoesNoHarm) {
  SpaceMouse mouse({}, kTick_s);
  constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
  for (const std::int32_t number : {-1, 99, kLargest, std::numeric_limits<std::int32_t>::lowest()}) {
    daemon_->send({number, number, number, number, number, number, number, number});
    daemon_->send({kPress, number});
    daemon_->send({kMotion, number, -number / 2, number, number, number, number, number});
    daemon_->send({4, number, number});  // settings
  }
  daemon_->send({kPress, 3});
  ASSERT_TRUE(eventually([&] { return mouse.read().buttons == 1U << 3; }));
  for (int i = 0; i < 5000; ++i) {
    const DeviceInput input = mouse.read();
    ASSERT_TRUE(input.pose.position_m.allFinite());
    ASSERT_LE(input.pose.position_m.norm(), mouse.limits().workspace_radius_m + 1e-15);
    ASSERT_LE(input.twist.linear_m_s.norm(), SteeredHandle::kMaxSpeed_m_s);
  }
  EXPECT_EQ(mouse.read().state, DeviceState::kLive);
}

TEST_F(SpaceMouseTest, ThereIsOneAtATime) {
  {
    const SpaceMouse mouse({}, kTick_s);
    EXPECT_THAT([] { SpaceMouse({}, kTick_s); }, ThrowsMessage<Failure>(HasSubstr("in use by this program")));
    EXPECT_TRUE(findSpaceMouse({})[0].usable);
  }
  EXPECT_EQ(SpaceMouse({}, kTick_s).read().state, DeviceState::kLive);
}

TEST_F(SpaceMouseTest, AllocatesNothingInTheTick) {
  const long before_all = allocationsOfThisThread();
  SpaceMouse mouse({}, kTick_s);
  ASSERT_GT(allocationsOfThisThread(), before_all) << "the counter does not count";
  daemon_->send(motion({.x = kFull, .ry = kFull}));
  ASSERT_TRUE(eventually([&] { return mouse.read().twist.linear_m_s.x() > 0; }));
  const long before = allocationsOfThisThread();
  for (int i = 0; i < 2000; ++i) {
    (void)mouse.read();
    mouse.write({});
  }
  mouse.releaseForce();
  mouse.resumeForce();
  EXPECT_EQ(allocationsOfThisThread(), before);
}

TEST_F(SpaceMouseTest, IsFoundWhenTheDaemonHasAPuck) {
  const std::vector<DeviceReport> found = findSpaceMouse({});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, DeviceKind::kSpaceMouse);
  EXPECT_TRUE(found[0].usable) << found[0].why_not;
}

TEST_F(SpaceMouseTest, SaysThatTheDaemonHasNoPuck) {
  daemon_.reset();
  daemon_.emplace(false);
  EXPECT_THAT([] { SpaceMouse({}, kTick_s); },
              ThrowsMessage<Failure>(HasSubstr("spacenavd runs, but has no SpaceMouse: plug it in")));
  const DeviceReport report = findSpaceMouse({}).at(0);
  EXPECT_FALSE(report.usable);
  EXPECT_THAT(report.remedy, HasSubstr("plug it in"));
}

TEST_F(SpaceMouseTest, SaysHowToGetTheDaemonWhenThereIsNone) {
  daemon_.reset();
  if (std::filesystem::exists("/var/run/spnav.sock")) {
    GTEST_SKIP() << "this machine has a daemon";
  }
  EXPECT_THAT([] { SpaceMouse({}, kTick_s); },
              ThrowsMessage<Failure>(
                  testing::AllOf(HasSubstr("/var/run/spnav.sock"), HasSubstr("sudo apt-get install spacenavd"))));
  const DeviceReport report = findSpaceMouse({}).at(0);
  EXPECT_FALSE(report.usable);
  EXPECT_THAT(report.remedy, HasSubstr("sudo apt-get install spacenavd"));
}

TEST_F(SpaceMouseTest, RefusesAnotherId) {
  DeviceParameters parameters;
  parameters.id = "SpaceBall";
  EXPECT_THROW(SpaceMouse(parameters, kTick_s), InvalidParameter);
}

TEST_F(SpaceMouseTest, ShowsNoForce) {
  const DeviceLimits limits = SpaceMouse({}, kTick_s).limits();
  EXPECT_EQ(limits.max_force_n, 0);
  EXPECT_EQ(limits.max_torque_nm, 0);
  EXPECT_EQ(limits.max_gripper_force_n, 0);
  EXPECT_TRUE(limits.turns);
}

}  // namespace
}  // namespace haptolith

#include "haptolith/device/drivers/inverse3.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <thread>

#include "haptolith/core/error.h"

#include "haply_service.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

DeviceParameters at(const std::string& address, const std::string& id = "") {
  DeviceParameters parameters;
  parameters.kind = DeviceKind::kInverse3;
  parameters.id = id;
  parameters.address = address;
  return parameters;
}

/// A loop that shows a force until something is so, or half a minute has passed: a busy machine is slow.
bool shows(Inverse3& device, const Vec3& force_n, const std::function<bool(const DeviceInput&)>& so) {
  const auto end = Clock::now() + 30s;
  while (Clock::now() < end) {
    const DeviceInput input = device.read();
    if (so(input)) {
      return true;
    }
    device.write({{force_n, Vec3::Zero()}});
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

bool becomes(Inverse3& device, DeviceState state) {
  return shows(device, Vec3::Zero(), [&](const DeviceInput& input) { return input.state == state; });
}

template <class Error = Failure>
std::string refusal(const DeviceParameters& parameters) {
  try {
    const Inverse3 device(parameters);
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "not refused";
  return {};
}

/// An unused port of this machine.
std::string nobody() {
  boost::asio::io_context io;
  const boost::asio::ip::tcp::acceptor acceptor(io, {boost::asio::ip::make_address("127.0.0.1"), 0});
  return "ws://127.0.0.1:" + std::to_string(acceptor.local_endpoint().port());
}

TEST(Inverse3, TellsTheArmAndItsGrip) {
  const HaplyService service({});
  Inverse3 device(at(service.address()));
  ASSERT_TRUE(becomes(device, DeviceState::kLive));
  const DeviceInput input = device.read();
  EXPECT_EQ(input.pose.position_m, Vec3(0.01, -0.12, 0.15));
  EXPECT_EQ(input.pose.orientation.coeffs(), Quat(0.5, -0.5, 0.5, -0.5).coeffs());
  EXPECT_EQ(input.buttons, 0b101U);
  EXPECT_TRUE(device.limits().turns);
  EXPECT_EQ(device.limits().max_torque_nm, 0);
  EXPECT_EQ(device.problem(), "");
  EXPECT_EQ(device.badAnswers(), 0U);
}

TEST(Inverse3, WithoutAGripItDoesNotTurn) {
  HaplyService::Behaviour behaviour;
  behaviour.inventory = R"({"inverse3":[{"device_id":"049D"}]})";
  behaviour.dialect = HaplyDialect::kValues;
  const HaplyService service(behaviour);
  Inverse3 device(at(service.address()));
  ASSERT_TRUE(becomes(device, DeviceState::kLive));
  EXPECT_FALSE(device.limits().turns);
  EXPECT_EQ(device.read().pose.orientation.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(device.read().buttons, 0U);
}

TEST(Inverse3, ShowsTheForceInTheServicesDialect) {
  for (const HaplyDialect dialect : {HaplyDialect::kVector, HaplyDialect::kValues}) {
    HaplyService::Behaviour behaviour;
    behaviour.dialect = dialect;
    behaviour.inventory = HaplyService::inventory(dialect);
    const HaplyService service(behaviour);
    Inverse3 device(at(service.address(), "049D"));
    const Vec3 force_n(0.5, -1.25, 2);
    EXPECT_TRUE(shows(device, force_n, [&](const DeviceInput&) { return service.force() == force_n; }));
    EXPECT_EQ(service.misunderstood(), 0);
  }
}

TEST(Inverse3, IsTheServicesClockButNoFasterThanAMillisecond) {
  const HaplyService service({});
  const auto began = Clock::now();
  Inverse3 device(at(service.address()));
  ASSERT_TRUE(shows(device, Vec3::Zero(), [&](const DeviceInput&) { return service.commands() >= 100; }));
  EXPECT_GE(Clock::now() - began, 98ms);
}

TEST(Inverse3, ForceIsZeroWhenTheLoopHasLetGoOrStopsOrWritesNonsense) {
  const HaplyService service({});
  Inverse3 device(at(service.address()));
  const Vec3 force_n(1, 2, 3);
  const auto pushes = [&](const DeviceInput&) { return service.force() == force_n; };
  const auto rests = [&](const DeviceInput&) { return service.force() == Vec3::Zero(); };
  ASSERT_TRUE(shows(device, force_n, pushes));
  std::thread other([&] { device.releaseForce(); });
  other.join();
  EXPECT_TRUE(shows(device, force_n, rests)) << "let go";
  const int then = service.commands();
  EXPECT_TRUE(shows(device, force_n, [&](const DeviceInput&) { return service.commands() > then + 20; }));
  EXPECT_EQ(service.force(), Vec3::Zero());
  device.resumeForce();
  ASSERT_TRUE(shows(device, force_n, pushes));

  const Vec3 nonsense(0, std::numeric_limits<double>::quiet_NaN(), 0);
  EXPECT_TRUE(shows(device, nonsense, rests));
  ASSERT_TRUE(shows(device, force_n, pushes));

  for (const auto end = Clock::now() + 10s; Clock::now() < end && service.force() != Vec3::Zero();) {
    std::this_thread::sleep_for(1ms);  // the loop does nothing
  }
  EXPECT_EQ(service.force(), Vec3::Zero());
  EXPECT_EQ(service.misunderstood(), 0);
}

TEST(Inverse3, ASilentServiceMakesItStaleAndIsNotPressed) {
  HaplyService::Behaviour behaviour;
  behaviour.silent_after = 30;
  const HaplyService service(behaviour);
  Inverse3 device(at(service.address()));
  ASSERT_TRUE(shows(device, Vec3::Zero(), [&](const DeviceInput&) { return service.commands() == 30; }));
  ASSERT_TRUE(becomes(device, DeviceState::kStale));
  EXPECT_EQ(device.read().pose.position_m.x(), 0.01) << "the last one known";
  EXPECT_EQ(device.read().twist.linear_m_s, Vec3::Zero());
  std::this_thread::sleep_for(30ms);
  EXPECT_EQ(service.commands(), 30) << "one answer for each message";
  EXPECT_EQ(device.problem(), "");
}

TEST(Inverse3, MessagesThatNobodyAskedForDoNotPileUp) {
  HaplyService::Behaviour behaviour;
  behaviour.answers_each = 100;  // more than this thread reads in a millisecond, on any machine
  // The position identifies the command.
  behaviour.answer = [](int command) { return HaplyService::state(fmt::format("{:.6f}", 1e-5 * command)); };
  const HaplyService service(behaviour);
  Inverse3 device(at(service.address()));
  ASSERT_TRUE(shows(device, Vec3::Zero(), [&](const DeviceInput&) { return service.commands() >= 200; }));
  EXPECT_TRUE(shows(device, Vec3::Zero(), [&](const DeviceInput& input) {
    return service.commands() - std::lround(1e5 * input.pose.position_m.x()) <= 2;
  }));
}

TEST(Inverse3, SaysWhenTheZeroOfLettingGoIsOut) {
  const HaplyService service({});
  Inverse3 device(at(service.address()));
  const Vec3 force_n(0.5, -1.25, 2);
  ASSERT_TRUE(shows(device, force_n, [&](const DeviceInput&) { return service.force() == force_n; }));
  device.releaseForce();
  const auto end = Clock::now() + 10s;
  while (device.forceRelease() != ForceRelease::kDone && Clock::now() < end) {
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(device.forceRelease(), ForceRelease::kDone);
  EXPECT_TRUE(shows(device, force_n, [&](const DeviceInput&) { return service.force() == Vec3::Zero(); }));
}

TEST(Inverse3, AServiceThatEndsTheConnectionIsALostDevice) {
  HaplyService::Behaviour behaviour;
  behaviour.closes_after = 20;
  const HaplyService service(behaviour);
  Inverse3 device(at(service.address()));
  ASSERT_TRUE(becomes(device, DeviceState::kLost));
  EXPECT_THAT(std::string(device.problem()), AllOf(HasSubstr(service.address()), HasSubstr("start again")));
  device.releaseForce();
  device.write({});
  EXPECT_EQ(device.read().state, DeviceState::kLost);
}

TEST(Inverse3, AServiceThatDiesIsALostDevice) {
  auto service = std::make_unique<HaplyService>(HaplyService::Behaviour{});
  Inverse3 device(at(service->address()));
  ASSERT_TRUE(becomes(device, DeviceState::kLive));
  service.reset();
  EXPECT_TRUE(becomes(device, DeviceState::kLost));
}

TEST(Inverse3, BadAnswersAreLeftOutOneByOne) {
  const char* const numbers[] = {"NaN", "null", "\"0.1\"", "1e999", "-3", "[]", ""};
  HaplyService::Behaviour behaviour;
  behaviour.answer = [&](int n) {
    return n % 2 == 0 ? HaplyService::state("0.02") : HaplyService::state(numbers[n / 2 % 7]);
  };
  const HaplyService service(behaviour);
  Inverse3 device(at(service.address()));
  EXPECT_TRUE(shows(device, Vec3::Zero(), [&](const DeviceInput& input) {
    EXPECT_TRUE(input.pose.position_m.x() == 0.01 || input.pose.position_m.x() == 0.02);
    return device.badAnswers() >= 14 && input.pose.position_m.x() == 0.02;
  }));
}

TEST(Inverse3, NothingButBadAnswersIsAsSilence) {
  for (const char* answer : {"{", "{}", "[]", "", R"({"inverse3":[{"device_id":"0FFF"}]})"}) {
    HaplyService::Behaviour behaviour;
    behaviour.answer = [&](int n) { return n < 5 ? HaplyService::state() : answer; };
    const HaplyService service(behaviour);
    Inverse3 device(at(service.address()));
    ASSERT_TRUE(shows(device, Vec3::Zero(), [&](const DeviceInput& input) {
      return input.state == DeviceState::kStale && device.badAnswers() > 10;
    })) << answer;
  }
}

TEST(Inverse3, AnAnswerTooLongToBeOneEndsTheConnection) {
  HaplyService::Behaviour behaviour;
  behaviour.answer = [](int n) { return n < 5 ? HaplyService::state() : std::string(300'000, ' '); };
  const HaplyService service(behaviour);
  Inverse3 device(at(service.address()));
  EXPECT_TRUE(becomes(device, DeviceState::kLost));
}

TEST(Inverse3, SaysWhyItCannotBeOpenedAndWhatToDo) {
  EXPECT_THAT(refusal(at(nobody())), AllOf(HasSubstr("Connection refused"), HasSubstr("start the Haply Hub")));
  HaplyService::Behaviour behaviour;
  {
    const HaplyService service(behaviour);
    EXPECT_THAT(refusal(at(service.address(), "1234")), AllOf(HasSubstr("'1234'"), HasSubstr("049D, 0FFF")));
  }
  behaviour.inventory = R"({"session_id":7,"inverse3":[]})";
  {
    const HaplyService service(behaviour);
    EXPECT_THAT(refusal(at(service.address())), AllOf(HasSubstr("has no Inverse3"), HasSubstr("plug it in")));
  }
  behaviour.inventory = "hello";
  {
    const HaplyService service(behaviour);
    EXPECT_THAT(refusal(at(service.address())), HasSubstr("another program listens there"));
  }
  behaviour.begins = false;
  {
    const HaplyService service(behaviour);
    EXPECT_THAT(refusal(at(service.address())), HasSubstr("cannot hear from the Haply service"));
  }
}

TEST(Inverse3, RefusesAddressesThatAreNone) {
  for (const char* address : {"localhost:10001", "http://localhost:10001", "ws://localhost", "ws://localhost:0",
                              "ws://localhost:70000", "ws://:10001", "ws://example.org:10001", "ws://"}) {
    EXPECT_THAT(refusal<InvalidParameter>(at(address)), AllOf(HasSubstr(address), HasSubstr("ws://localhost:10001")));
    EXPECT_THROW((void)findInverse3(at(address)), InvalidParameter);
  }
}

TEST(FindInverse3, ListsWhatTheServiceKnows) {
  const HaplyService service({});
  const auto reports = findInverse3(at(service.address() + "/"));
  ASSERT_EQ(reports.size(), 2U);
  EXPECT_EQ(reports[0].kind, DeviceKind::kInverse3);
  EXPECT_EQ(reports[0].id, "049D");
  EXPECT_EQ(reports[1].id, "0FFF");
  EXPECT_TRUE(reports[0].usable && reports[1].usable);
}

TEST(FindInverse3, SaysWhyThereIsNoneSoon) {
  auto reports = findInverse3(at(nobody()));
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_FALSE(reports[0].usable);
  EXPECT_THAT(reports[0].why_not, HasSubstr("Connection refused"));
  EXPECT_THAT(reports[0].remedy, testing::StartsWith("start the Haply Hub"));

  HaplyService::Behaviour behaviour;
  behaviour.shakes_hands = false;
  const HaplyService service(behaviour);
  const auto began = Clock::now();
  reports = findInverse3(at(service.address()));
  EXPECT_LT(Clock::now() - began, 2s);
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_FALSE(reports[0].usable);
  EXPECT_THAT(reports[0].why_not, HasSubstr("does not respond in time"));

  behaviour.shakes_hands = true;
  behaviour.inventory = "{}";
  const HaplyService empty(behaviour);
  EXPECT_THAT(findInverse3(at(empty.address()))[0].why_not, HasSubstr("has no Inverse3"));
}

}  // namespace
}  // namespace haptolith

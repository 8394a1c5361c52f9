// The driver against a mock of the SDK (force_dimension_stand_in.h): no device of Force Dimension was available.

#include "haptolith/device/drivers/force_dimension.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/core/error.h"

#include "../counted_new.h"
#include "force_dimension_stand_in.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const char* const kPose = "dhdGetPositionAndOrientationFrame";
const char* const kSet = "dhdSetForceAndTorqueAndGripperForce";

StandIn& ordered() {
  static StandIn* const stand_in = [] {
    const SharedLibrary library(HAPTOLITH_STAND_IN);
    StandIn* (*const get)() = library.symbol("standIn");
    return get();
  }();
  return *stand_in;
}

class ForceDimensionTest : public testing::Test {
 protected:
  ForceDimensionTest()
      : folder_(fs::temp_directory_path() / ("haptolith-force-dimension-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    for (const char* variable : {"FORCEDIM_SDK", "FDSDK", "LD_LIBRARY_PATH"}) {
      unsetenv(variable);
    }
    std::destroy_at(&ordered());
    std::construct_at(&ordered());
    parameters_.kind = DeviceKind::kForceDimension;
    parameters_.library = HAPTOLITH_STAND_IN;
    places_.usb_devices = folder_ / "usb";
    places_.local_libraries = folder_ / "local";
    places_.homing_patience_s = 0.02;
  }
  ~ForceDimensionTest() override {
    for (const char* variable : {"FORCEDIM_SDK", "FDSDK", "LD_LIBRARY_PATH"}) {
      unsetenv(variable);
    }
    fs::remove_all(folder_);
  }

  std::unique_ptr<ForceDimension> open() { return std::make_unique<ForceDimension>(parameters_, places_); }

  std::string failure() {
    try {
      (void)open();
    } catch (const Failure& failure) {
      return failure.what();
    }
    return "it worked";
  }

  /// The calls since the last query.
  static std::vector<std::string> calls() {
    const auto& all = ordered().calls;
    std::vector<std::string> some(all.begin(),
                                  all.begin() + std::min<int>(ordered().called, static_cast<int>(all.size())));
    ordered().called = 0;
    return some;
  }

  /// A library in a separate folder.
  fs::path library(const fs::path& path, const char* of = HAPTOLITH_STAND_IN) const {
    fs::create_directories((folder_ / path).parent_path());
    fs::create_symlink(of, folder_ / path);
    return folder_ / path;
  }

  void plugIn(const char* port, const char* vendor, const char* product, const char* name) const {
    const fs::path device = folder_ / "usb" / port;
    fs::create_directories(device);
    std::ofstream(device / "idVendor") << vendor << '\n';
    std::ofstream(device / "idProduct") << product << '\n';
    std::ofstream(device / "product") << name << '\n';
  }

  fs::path folder_;
  DeviceParameters parameters_;
  ForceDimensionPlaces places_;
};

/// Whether this machine has the SDK where the loader finds it: searches end there.
bool loaderFindsAnSdk() {
  try {
    const SharedLibrary found("libdrd.so.3");
    return true;
  } catch (const Failure&) {
    return false;
  }
}

DeviceOutput push() {
  return {.wrench = {Vec3(1, 2, 3), Vec3(0.01, 0.02, 0.03)}, .gripper_force_n = 4};
}

// --- finding the SDK
// --------------------------------------------------------------------------------------------------

using ForceDimensionSearch = ForceDimensionTest;

TEST_F(ForceDimensionSearch, ANamedLibraryIsTakenAndNoOther) {
  library("local/libdrd.so.3.17.6");
  const fs::path named = library("elsewhere/mine.so");
  EXPECT_EQ(ForceDimensionSdk(named, places_).library.path(), named);
  parameters_.library = folder_ / "elsewhere/not_mine.so";
  EXPECT_THAT(failure(), AllOf(HasSubstr("not_mine.so"), HasSubstr("No such file"), Not(HasSubstr("local"))));
}

TEST_F(ForceDimensionSearch, TheNewestVersionInAFolderComesFirst) {
  library("sdk/libdrd.so");
  library("sdk/libdrd.so.3.17.6");
  const fs::path newest = library("sdk/libdrd.so.3.17.10");
  library("sdk/libdhd.so.3.18.0");
  EXPECT_EQ(ForceDimensionSdk(folder_ / "sdk", places_).library.path(), newest);
}

TEST_F(ForceDimensionSearch, WhatCannotBeLoadedIsPassedOver) {
  const fs::path good = library("sdk/libdrd.so.3.17.6");
  std::ofstream(folder_ / "sdk/libdrd.so.3.99.0") << "for another machine";
  EXPECT_EQ(ForceDimensionSdk(folder_ / "sdk", places_).library.path(), good);
}

TEST_F(ForceDimensionSearch, FoldersAreSearchedInTheirOrder) {
  const fs::path local = library("local/libdrd.so.3.14.0");
  EXPECT_EQ(ForceDimensionSdk({}, places_).library.path(), loaderFindsAnSdk() ? fs::path("libdrd.so.3") : local);

  const fs::path loaders = library("loaders/libdrd.so.3.15.0");
  setenv("LD_LIBRARY_PATH", ("/nowhere::" + (folder_ / "loaders").string()).c_str(), 1);
  EXPECT_EQ(ForceDimensionSdk({}, places_).library.path(), loaders);

  const fs::path second = library("fdsdk/lib/release/lin-x86_64-gcc/libdrd.so.3.16.0");
  setenv("FDSDK", (folder_ / "fdsdk").c_str(), 1);
  EXPECT_EQ(ForceDimensionSdk({}, places_).library.path(), second);

  const fs::path first = library("sdk-3.17.6/lib/release/lin-x86_64-gcc/libdrd.so.3.17.6");
  setenv("FORCEDIM_SDK", (folder_ / "sdk-3.17.6").c_str(), 1);
  EXPECT_EQ(ForceDimensionSdk({}, places_).library.path(), first);
}

TEST_F(ForceDimensionSearch, AFailureNamesEveryPathThatWasTried) {
  if (loaderFindsAnSdk()) {
    GTEST_SKIP() << "the SDK is installed here";
  }
  parameters_.library.clear();
  setenv("FORCEDIM_SDK", (folder_ / "one").c_str(), 1);
  setenv("FDSDK", (folder_ / "two").c_str(), 1);
  fs::create_directories(folder_ / "two");
  std::ofstream(folder_ / "two/libdrd.so.3.17.6") << "no library";
  EXPECT_THAT(failure(), AllOf(HasSubstr("there is no " + (folder_ / "one/libdrd.so*").string() + "\n"),
                               HasSubstr((folder_ / "one/lib/release/lin-*-gcc/libdrd.so*").string()),
                               HasSubstr((folder_ / "two/libdrd.so.3.17.6").string()),
                               HasSubstr("cannot load libdrd.so.3"), HasSubstr((folder_ / "local/libdrd.so*").string()),
                               HasSubstr("forcedimension.com"), HasSubstr("FORCEDIM_SDK")));
}

TEST_F(ForceDimensionSearch, AFunctionThatIsMissingIsNamedWithItsLibrary) {
  parameters_.library = HAPTOLITH_STAND_IN_INCOMPLETE;
  EXPECT_THAT(failure(), AllOf(HasSubstr("dhdSetWatchdog"), HasSubstr(HAPTOLITH_STAND_IN_INCOMPLETE),
                               HasSubstr("too old"), HasSubstr("3.14 or newer")));
}

// --- finding devices
// --------------------------------------------------------------------------------------------------

using ForceDimensionReports = ForceDimensionTest;

TEST_F(ForceDimensionReports, EveryDeviceIsListedWithItsSerialNumberAndClosedAgain) {
  ordered().devices = 3;
  ordered().device[1] = {.name = "omega.3", .type = 33, .serial = 0};
  ordered().device[2] = {.name = "delta.3", .type = 63, .serial = 12, .in_use = true};
  plugIn("1-1", "1451", "0402", "sigma.x haptic device");
  const auto reports = findForceDimension(parameters_, places_);
  ASSERT_EQ(reports.size(), 3U);
  EXPECT_EQ(reports[0].kind, DeviceKind::kForceDimension);
  EXPECT_TRUE(reports[0].usable);
  EXPECT_EQ(reports[0].name, "sigma.7");
  EXPECT_EQ(reports[0].id, "4711");
  EXPECT_THAT(reports[0].why_not, IsEmpty());
  EXPECT_EQ(reports[1].name, "omega.3");
  EXPECT_EQ(reports[1].id, "1") << "without a serial number its place in the list";
  EXPECT_FALSE(reports[2].usable);
  EXPECT_THAT(reports[2].why_not, AllOf(HasSubstr("dhdOpenID(2)"), HasSubstr("device in use")));
  EXPECT_THAT(reports[2].remedy, AllOf(HasSubstr("other program"), Not(HasSubstr("udev"))));
  EXPECT_THAT(calls(), ElementsAre("dhdOpenID", "dhdClose", "dhdOpenID", "dhdClose", "dhdOpenID"));
}

TEST_F(ForceDimensionReports, WithoutAnSdkOneReportSaysSo) {
  parameters_.library = folder_ / "none.so";
  plugIn("1-1", "1451", "0402", "sigma.x haptic device");
  const auto reports = findForceDimension(parameters_, places_);
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_FALSE(reports[0].usable);
  EXPECT_THAT(reports[0].why_not, AllOf(HasSubstr("none.so"), HasSubstr("sigma.x haptic device (USB 1451:0402)")));
  EXPECT_THAT(reports[0].remedy, HasSubstr("forcedimension.com"));
}

TEST_F(ForceDimensionReports, WithoutADeviceOneReportSaysSo) {
  ordered().devices = 0;
  plugIn("1-1", "046d", "c52b", "mouse");
  plugIn("1-2", "0403", "6001", "some other FTDI chip");
  const auto reports = findForceDimension(parameters_, places_);
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_FALSE(reports[0].usable);
  EXPECT_THAT(reports[0].why_not, AllOf(HasSubstr("no device"), HasSubstr("1451"), HasSubstr(places_.usb_devices)));
  EXPECT_THAT(reports[0].remedy, HasSubstr("plug"));
}

TEST_F(ForceDimensionReports, ADeviceThatIsPluggedInButNotSeenGetsAUdevRule) {
  ordered().devices = 0;
  plugIn("2-1", "0403", "cb48", "");
  const auto reports = findForceDimension(parameters_, places_);
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_THAT(reports[0].why_not, HasSubstr("plugged in: Novint Falcon (USB 0403:cb48)"));
  EXPECT_THAT(reports[0].remedy, AllOf(HasSubstr("/etc/udev/rules.d/"), HasSubstr(forceDimensionUdevRule())));
  EXPECT_THAT(failure(), AllOf(HasSubstr("drdOpen"), HasSubstr("no device"), HasSubstr(forceDimensionUdevRule())));
}

TEST_F(ForceDimensionReports, TheUdevRuleNamesBothVendors) {
  EXPECT_THAT(forceDimensionUdevRule(), AllOf(HasSubstr("ATTR{idVendor}==\"1451\""),
                                              HasSubstr("ATTR{idProduct}==\"cb48\""), HasSubstr("TAG+=\"uaccess\"")));
}

// --- start and end
// ----------------------------------------------------------------------------------------------------

using ForceDimensionStart = ForceDimensionTest;

TEST_F(ForceDimensionStart, FindsItsZeroThenSwitchesForcesOnAtZeroThenSetsTheWatchdog) {
  ordered().wrench.fill(1);
  const auto device = open();
  EXPECT_THAT(calls(), ElementsAre("drdOpen", "drdAutoInit", "drdStop(true)", "dhdSetMaxForce", "dhdSetMaxTorque",
                                   "dhdSetMaxGripperForce", "dhdSetBrakes(off)", "dhdEnableForce(on)",
                                   "dhdSetGravityCompensation", kSet, "dhdEnableExpertMode", "dhdSetWatchdog",
                                   "dhdDisableExpertMode", kPose, "dhdGetLinearVelocity", "dhdGetAngularVelocityRad",
                                   "dhdGetGripperAngleRad"));
  EXPECT_EQ(device->name(), "sigma.7");
  EXPECT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0));
  EXPECT_EQ(ordered().max_force, 12);
  EXPECT_EQ(ordered().max_torque, 0.2);
  EXPECT_EQ(ordered().max_gripper, 8);
  EXPECT_EQ(ordered().watchdog * 0.125, 10) << "ms";
  EXPECT_FALSE(ordered().expert);
  EXPECT_TRUE(ordered().gravity);
  EXPECT_FALSE(device->simulated());
  EXPECT_THAT(device->problem(), IsEmpty());
}

TEST_F(ForceDimensionStart, ADeviceThatKnowsItsZeroDoesNotMove) {
  ordered().initialized = true;
  (void)open();
  EXPECT_THAT(calls(), AllOf(Not(testing::Contains("drdAutoInit")), Not(testing::Contains("drdStop(true)"))));
}

TEST_F(ForceDimensionStart, EndsWithAZeroWrenchStoppedAndClosed) {
  auto device = open();
  device->write(push());
  (void)calls();
  device.reset();
  EXPECT_THAT(calls(), ElementsAre(kSet, "dhdStop", "drdClose"));
  EXPECT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0));
  EXPECT_FALSE(ordered().open);
}

TEST_F(ForceDimensionStart, EveryCallThatFailsIsNamedWithReasonAndRemedyAndTheDeviceIsClosed) {
  for (const char* call : {"drdAutoInit", "drdStop(true)", "dhdSetMaxForce", "dhdSetMaxTorque", "dhdSetMaxGripperForce",
                           "dhdSetBrakes(off)", "dhdEnableForce(on)", "dhdSetGravityCompensation", kSet,
                           "dhdEnableExpertMode", "dhdSetWatchdog", "dhdDisableExpertMode"}) {
    std::destroy_at(&ordered());
    std::construct_at(&ordered());
    ordered().failing = call;
    const std::string bare = std::string(call).substr(0, std::string(call).find('('));
    EXPECT_THAT(failure(),
                AllOf(StartsWith("sigma.7: " + bare + " failed: communication error"), HasSubstr("What to do: ")));
    const auto made = calls();
    ASSERT_GE(made.size(), 4U) << call;
    EXPECT_THAT(std::vector(made.end() - 3, made.end()), ElementsAre(kSet, "dhdStop", "drdClose")) << call;
    EXPECT_FALSE(ordered().open) << call;
  }
}

TEST_F(ForceDimensionStart, AFirstReadingThatFailsEndsItToo) {
  ordered().failing = kPose;
  EXPECT_THAT(failure(), AllOf(HasSubstr("first reading"), HasSubstr("communication error")));
  EXPECT_FALSE(ordered().open);
  ordered().failing = nullptr;
  ordered().not_a_number = true;
  EXPECT_THAT(failure(), HasSubstr("first pose"));
  EXPECT_FALSE(ordered().open);
}

TEST_F(ForceDimensionStart, OpeningThatFailsIsTold) {
  ordered().failing = "drdOpen";
  EXPECT_THAT(failure(), AllOf(HasSubstr("drdOpen failed: communication error"), HasSubstr("What to do")));
  EXPECT_THAT(calls(), ElementsAre("drdOpen")) << "nothing was opened that would have to be closed";
}

TEST_F(ForceDimensionStart, ADeviceWithoutWatchdogWorksWithoutIt) {
  ordered().failing = "dhdSetWatchdog";
  for (const int error : {6, 10}) {
    ordered().error = error;
    EXPECT_EQ(failure(), "it worked");
  }
}

TEST_F(ForceDimensionStart, OneOfSeveralIsChosenBySerialThenPlaceThenName) {
  ordered().devices = 3;
  ordered().device[1] = {.name = "omega.7", .type = 35, .serial = 2};
  ordered().device[2] = {.name = "delta.3", .type = 63, .serial = 815};
  for (const auto& [id, name] : std::vector<std::pair<std::string, std::string>>{{"", "sigma.7"},
                                                                                 {"4711", "sigma.7"},
                                                                                 {"815", "delta.3"},
                                                                                 {"2", "omega.7"},
                                                                                 {"0", "sigma.7"},
                                                                                 {"1", "omega.7"},
                                                                                 {"delta.3", "delta.3"}}) {
    parameters_.id = id;
    EXPECT_EQ(open()->name(), name) << id;
  }
  parameters_.id = "99";
  EXPECT_THAT(failure(), AllOf(HasSubstr("99"), HasSubstr("4711 (sigma.7), 2 (omega.7), 815 (delta.3)")));
}

TEST_F(ForceDimensionStart, WithoutAChoiceOneInUseIsPassedOver) {
  ordered().devices = 2;
  ordered().device[0].in_use = true;
  ordered().device[1] = {.name = "omega.3", .type = 33};
  EXPECT_EQ(open()->name(), "omega.3");
  parameters_.id = "0";
  EXPECT_THAT(failure(), AllOf(HasSubstr("drdOpenID"), HasSubstr("device in use")));
}

TEST_F(ForceDimensionStart, AFalconIsHomedByHand) {
  ordered().device[0] = {
      .name = "Falcon", .type = 60, .wrist = false, .active_wrist = false, .gripper = false, .active_gripper = false};
  EXPECT_THAT(failure(), AllOf(HasSubstr("not homed within 0.02 s"), HasSubstr("push it in")));
  EXPECT_THAT(calls(), Not(testing::Contains("drdAutoInit")));
  EXPECT_FALSE(ordered().open);

  places_.homing_patience_s = 60;
  ordered().homed_by_forces = 5;
  const auto device = open();
  EXPECT_TRUE(ordered().initialized);
  EXPECT_EQ(device->limits().max_force_n, 8);
}

// --- limits
// -----------------------------------------------------------------------------------------------------------

using ForceDimensionLimits = ForceDimensionTest;

TEST_F(ForceDimensionLimits, ASigma7IsAsChai3dDescribesIt) {
  const DeviceLimits limits = open()->limits();
  EXPECT_EQ(limits.max_force_n, 12);
  EXPECT_EQ(limits.max_torque_nm, 0.2);
  EXPECT_EQ(limits.max_gripper_force_n, 8);
  EXPECT_NEAR(limits.max_force_rate_n_s, 4000, 1e-9);
  EXPECT_NEAR(limits.max_torque_rate_nm_s, 0.2 / 0.003, 1e-9);
  EXPECT_NEAR(limits.max_gripper_rate_n_s, 8 / 0.003, 1e-9);
  EXPECT_EQ(limits.max_stiffness_n_m, 4000);
  EXPECT_EQ(limits.max_stiffness_nm_rad, 1);
  EXPECT_EQ(limits.damping_n_s_m, 2) << "4000 N/m * 1 ms / 2";
  EXPECT_EQ(limits.workspace_radius_m, 0.075);
  EXPECT_EQ(limits.workspace_centre_m, Vec3(0.01, -0.02, 0));
  EXPECT_EQ(limits.rate_hz, 1000);
  EXPECT_TRUE(limits.turns);
}

TEST_F(ForceDimensionLimits, WhatADeviceLacksIsZero) {
  ordered().device[0] = {
      .name = "omega.3", .type = 33, .wrist = false, .active_wrist = false, .gripper = false, .active_gripper = false};
  const DeviceLimits limits = open()->limits();
  EXPECT_EQ(limits.max_force_n, 12);
  EXPECT_EQ(limits.max_torque_nm, 0);
  EXPECT_EQ(limits.max_gripper_force_n, 0);
  EXPECT_EQ(limits.max_stiffness_n_m, 5000);
  EXPECT_FALSE(limits.turns);
  EXPECT_THAT(calls(),
              AllOf(Not(testing::Contains("dhdSetMaxTorque")), Not(testing::Contains("dhdSetMaxGripperForce"))));
}

TEST_F(ForceDimensionLimits, AnUnknownDeviceGetsTheSmallest) {
  ordered().device[0] = {.name = "lambda.7", .type = 108};
  const DeviceLimits limits = open()->limits();
  for (const int type : {104, 105, 33, 34, 35, 36, 37, 63, 64, 60}) {
    ordered().device[0].type = type;
    const DeviceLimits known = open()->limits();
    EXPECT_LE(limits.max_force_n, known.max_force_n) << type;
    EXPECT_LE(limits.max_stiffness_n_m, known.max_stiffness_n_m) << type;
    EXPECT_LE(limits.workspace_radius_m, known.workspace_radius_m) << type;
    EXPECT_GT(known.damping_n_s_m, 0) << type;
  }
}

// --- reading
// ----------------------------------------------------------------------------------------------------------

using ForceDimensionRead = ForceDimensionTest;

TEST_F(ForceDimensionRead, TellsPoseVelocitiesGripperAndButtons) {
  const auto device = open();
  ordered().turned_rad = 0.5;
  ordered().gripper_rad = 15 * std::numbers::pi / 180;
  ordered().buttons = 5;
  const DeviceInput input = device->read();
  EXPECT_EQ(input.state, DeviceState::kLive);
  EXPECT_TRUE(input.pose.position_m.isApprox(Vec3(0.01, 0.02, 0.03), 1e-6));
  EXPECT_NEAR(input.pose.orientation.w(), std::cos(0.25), 1e-12);
  EXPECT_NEAR(input.pose.orientation.z(), std::sin(0.25), 1e-12) << "rows of the matrix are rows";
  EXPECT_EQ(input.twist.linear_m_s, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(input.twist.angular_rad_s, Vec3(1, 2, 3));
  EXPECT_NEAR(input.gripper_open, 0.5, 1e-12);
  EXPECT_EQ(input.buttons, 5U);
}

TEST_F(ForceDimensionRead, GripperOpeningStaysBetween0And1) {
  const auto device = open();
  ordered().gripper_rad = -0.1;
  EXPECT_EQ(device->read().gripper_open, 0);
  ordered().gripper_rad = 1;
  EXPECT_EQ(device->read().gripper_open, 1);
}

TEST_F(ForceDimensionRead, ALeftHandsGripperCountsTheOtherWayRound) {
  ordered().device[0] = {.type = 105, .left_handed = true};
  const auto device = open();
  ordered().gripper_rad = 15 * std::numbers::pi / 180;
  EXPECT_NEAR(device->read().gripper_open, 0.5, 1e-12);
  device->write(push());
  EXPECT_THAT(ordered().wrench, ElementsAre(1, 2, 3, 0.01, 0.02, 0.03, -4));
}

TEST_F(ForceDimensionRead, WithoutAWristTheTurnIsTheIdentity) {
  ordered().device[0] = {.name = "omega.3", .type = 33, .wrist = false, .active_wrist = false, .gripper = false};
  const auto device = open();
  ordered().turned_rad = 0.5;
  ordered().failing = "dhdGetAngularVelocityRad";
  const DeviceInput input = device->read();
  EXPECT_EQ(input.state, DeviceState::kLive);
  EXPECT_TRUE(input.pose.orientation.isApprox(Quat::Identity()));
  EXPECT_EQ(input.twist.angular_rad_s, Vec3(0, 0, 0));
  EXPECT_EQ(input.gripper_open, 0);
}

TEST_F(ForceDimensionRead, TheTimeGuardAndSaturatedMotorsAreNoErrors) {
  ordered().reading_result = 1;
  ordered().setting_result = 2;
  const auto device = open();
  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(device->read().state, DeviceState::kLive);
    device->write(push());
  }
}

TEST_F(ForceDimensionRead, VelocitiesThatAreNotThereYetAreZero) {
  const auto device = open();
  ordered().failing = "dhdGetLinearVelocity";
  ordered().error = ForceDimensionSdk::kErrorTimeout;
  const DeviceInput input = device->read();
  EXPECT_EQ(input.state, DeviceState::kLive);
  EXPECT_EQ(input.twist.linear_m_s, Vec3(0, 0, 0));
  EXPECT_EQ(input.twist.angular_rad_s, Vec3(1, 2, 3));
}

TEST_F(ForceDimensionRead, OneFailureIsStaleWithTheLastPoseAndNoVelocity) {
  const auto device = open();
  for (const char* call : {kPose, "dhdGetLinearVelocity", "dhdGetAngularVelocityRad", "dhdGetGripperAngleRad"}) {
    ordered().turned_rad = 0.1;
    const DeviceInput good = device->read();
    ASSERT_EQ(good.state, DeviceState::kLive) << call;
    ordered().failing = call;
    ordered().turned_rad = 0.2;
    const DeviceInput input = device->read();
    EXPECT_EQ(input.state, DeviceState::kStale) << call;
    EXPECT_EQ(input.pose.position_m, good.pose.position_m) << call;
    EXPECT_EQ(input.pose.orientation.coeffs(), good.pose.orientation.coeffs()) << call;
    EXPECT_EQ(input.twist.linear_m_s, Vec3(0, 0, 0)) << call;
    EXPECT_EQ(input.twist.angular_rad_s, Vec3(0, 0, 0)) << call;
    EXPECT_THAT(device->problem(), IsEmpty()) << call;
    ordered().failing = nullptr;
  }
}

TEST_F(ForceDimensionRead, TenFailuresInARowAreALostDevice) {
  const auto device = open();
  ordered().failing = kPose;
  ordered().failing_times = 9;
  for (int i = 0; i < 9; ++i) {
    ASSERT_EQ(device->read().state, DeviceState::kStale);
  }
  EXPECT_EQ(device->read().state, DeviceState::kLive) << "nine are not yet";
  ordered().failing_times = INT_MAX;
  for (int i = 0; i < 9; ++i) {
    ASSERT_EQ(device->read().state, DeviceState::kStale);
    device->write(push());
  }
  (void)calls();
  EXPECT_EQ(device->read().state, DeviceState::kLost);
  EXPECT_THAT(calls(), ElementsAre(kPose, kSet, "dhdStop"));
  EXPECT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(std::string(device->problem()),
              AllOf(StartsWith("sigma.7 is lost: dhdGetPositionAndOrientationFrame failed 10 times in a row: "
                               "communication error"),
                    HasSubstr("What to do: ")));

  ordered().failing = nullptr;
  EXPECT_EQ(device->read().state, DeviceState::kLost) << "for good";
  device->write(push());
  device->resumeForce();
  EXPECT_THAT(calls(), IsEmpty()) << "a lost device holds nobody up";
}

TEST_F(ForceDimensionRead, ADeviceThatTakesNoForcesIsStaleAndThenLost) {
  const auto device = open();
  ordered().failing = kSet;
  device->write(push());
  EXPECT_EQ(device->read().state, DeviceState::kStale);
  EXPECT_EQ(device->read().state, DeviceState::kLive) << "nothing was written meanwhile";
  DeviceState state = DeviceState::kLive;
  for (int i = 0; i < 10; ++i) {
    device->write(push());
    state = device->read().state;
  }
  EXPECT_EQ(state, DeviceState::kLost);
  EXPECT_THAT(std::string(device->problem()), HasSubstr("dhdSetForceAndTorqueAndGripperForce failed"));
}

TEST_F(ForceDimensionRead, WhatIsNotANumberIsNeverTold) {
  const auto device = open();
  ordered().not_a_number = true;
  for (int i = 0; i < 10; ++i) {
    const DeviceInput input = device->read();
    EXPECT_EQ(input.state, i < 9 ? DeviceState::kStale : DeviceState::kLost);
    EXPECT_TRUE(input.pose.position_m.allFinite());
  }
  EXPECT_THAT(std::string(device->problem()), HasSubstr("not finite"));
}

TEST_F(ForceDimensionRead, AMatrixThatIsNoRotationIsNeverTold) {
  const auto device = open();
  ordered().no_rotation = true;
  for (int i = 0; i < 10; ++i) {
    const DeviceInput input = device->read();
    EXPECT_EQ(input.state, i < 9 ? DeviceState::kStale : DeviceState::kLost);
    EXPECT_NEAR(input.pose.orientation.norm(), 1, 1e-12);
  }
  EXPECT_THAT(std::string(device->problem()), HasSubstr("not a rotation"));
}

TEST_F(ForceDimensionRead, APoseThatStaysTheSameUnderForceIsStaleUntilItChanges) {
  const auto device = open();
  ordered().frozen = true;
  for (int i = 0; i < 49; ++i) {
    device->write(push());
    ASSERT_EQ(device->read().state, DeviceState::kLive) << i;
  }
  device->write(push());
  EXPECT_EQ(device->read().state, DeviceState::kStale);
  for (int i = 0; i < 20; ++i) {
    device->write({});
    ASSERT_EQ(device->read().state, DeviceState::kStale) << "it does not come back by itself";
  }
  ordered().gripper_rad = 0.01;
  EXPECT_EQ(device->read().state, DeviceState::kLive);
}

TEST_F(ForceDimensionRead, AHandleThatHasBeenPutDownMayRest) {
  const auto device = open();
  ordered().frozen = true;
  for (int i = 0; i < 200; ++i) {
    device->write({});
    ASSERT_EQ(device->read().state, DeviceState::kLive);
  }
}

TEST_F(ForceDimensionRead, AHandThatMovesIsNeverStale) {
  const auto device = open();
  for (int i = 0; i < 500; ++i) {
    device->write(push());
    ASSERT_EQ(device->read().state, DeviceState::kLive);
  }
}

TEST_F(ForceDimensionRead, ForcesThatThePersonSwitchesOffComeBackWhenThePersonWants) {
  const auto device = open();
  ASSERT_EQ(device->read().state, DeviceState::kLive);
  ordered().forces_on = false;
  ordered().forces_off_cause = 1;  // the button
  int reads = 0;
  while (device->read().state == DeviceState::kLive && ++reads < 1000) {
  }
  EXPECT_LE(reads, 50);
  for (int i = 0; i < 100; ++i) {
    const DeviceInput input = device->read();
    ASSERT_EQ(input.state, DeviceState::kStale);
    ASSERT_EQ(input.twist.linear_m_s, Vec3(0.1, 0.2, 0.3)) << "where the handle is, is still known";
  }
  EXPECT_FALSE(ordered().forces_on);
  ordered().forces_on = true;
  EXPECT_EQ(device->read().state, DeviceState::kLive);
}

TEST_F(ForceDimensionRead, ATripOfTheWatchdogIsTakenBackAtZeroForce) {
  const auto device = open();
  (void)device->read();
  device->write(push());
  ordered().forces_on = false;
  ordered().forces_off_cause = 3;
  (void)calls();
  int reads = 0;
  while (device->read().state == DeviceState::kLive && ++reads < 1000) {
  }
  EXPECT_LE(reads, 50);
  EXPECT_TRUE(ordered().forces_on);
  EXPECT_FALSE(ordered().brakes);
  EXPECT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0));
  EXPECT_EQ(device->read().state, DeviceState::kLive);
}

TEST_F(ForceDimensionRead, ADeviceThatNeverTellsOfItsForcesIsLiveNevertheless) {
  const auto device = open();
  ordered().forces_on = false;
  for (int i = 0; i < 120; ++i) {
    ASSERT_EQ(device->read().state, DeviceState::kLive);
  }
}

// --- writing and releasing
// -------------------------------------------------------------------------------------------

using ForceDimensionWrite = ForceDimensionTest;

TEST_F(ForceDimensionWrite, SendsTheWrenchAsItIs) {
  const auto device = open();
  device->write(push());
  EXPECT_THAT(ordered().wrench, ElementsAre(1, 2, 3, 0.01, 0.02, 0.03, 4));
}

TEST_F(ForceDimensionWrite, SendsOnlyWhatTheDeviceHasMotorsFor) {
  ordered().device[0] = {.name = "omega.6", .type = 34, .active_wrist = false, .active_gripper = false};
  const auto device = open();
  device->write(push());
  EXPECT_THAT(ordered().wrench, ElementsAre(1, 2, 3, 0, 0, 0, 0));
}

TEST_F(ForceDimensionWrite, SendsZeroForWhatIsNotANumber) {
  const auto device = open();
  DeviceOutput output = push();
  output.wrench.torque_nm.y() = std::numeric_limits<double>::quiet_NaN();
  device->write(output);
  EXPECT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0));
}

TEST_F(ForceDimensionWrite, LettingGoStopsAtOnceAndForGoodUntilItIsTakenUp) {
  const auto device = open();
  device->write(push());
  (void)calls();
  std::thread([&] { device->releaseForce(); }).join();
  EXPECT_THAT(calls(), ElementsAre(kSet, "dhdStop"));
  EXPECT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0));
  EXPECT_TRUE(ordered().brakes);
  for (int i = 0; i < 60; ++i) {
    device->write(push());
    EXPECT_EQ(device->read().state, DeviceState::kLive) << "its forces are off because we want it";
  }
  device->releaseForce();
  EXPECT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0));
  EXPECT_FALSE(ordered().forces_on);

  (void)calls();
  device->resumeForce();
  EXPECT_THAT(calls(), ElementsAre("dhdSetBrakes(off)", "dhdEnableForce(on)", kSet));
  EXPECT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0));
  device->write(push());
  EXPECT_THAT(ordered().wrench, ElementsAre(1, 2, 3, 0.01, 0.02, 0.03, 4));
}

TEST_F(ForceDimensionWrite, LettingGoWhileTheLoopIsInTheSdkWaitsForNobody) {
  const auto device = open();
  ordered().hangs = true;
  std::thread loop([&] { device->write(push()); });
  while (!ordered().in_call) {
    std::this_thread::yield();
  }
  device->releaseForce();  // would wait for ever if it called the SDK
  EXPECT_TRUE(ordered().forces_on);
  ordered().hangs = false;
  loop.join();
  EXPECT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0)) << "who was in the SDK has stopped the device";
  EXPECT_FALSE(ordered().forces_on);
}

ForceDimension* signalled = nullptr;

TEST_F(ForceDimensionWrite, LettingGoInASignalsHandlerWorks) {
  const auto device = open();
  signalled = device.get();
  const auto before = std::signal(SIGUSR1, [](int) { signalled->releaseForce(); });
  device->write(push());
  (void)std::raise(SIGUSR1);
  EXPECT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0));
  EXPECT_FALSE(ordered().forces_on);

  device->resumeForce();
  ordered().raises = SIGUSR1;  // while the SDK holds its lock: who called it then would wait for itself
  device->write(push());
  EXPECT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0));
  EXPECT_FALSE(ordered().forces_on);
  (void)std::signal(SIGUSR1, before);
}

TEST_F(ForceDimensionWrite, AStopThatFailedIsTriedAgain) {
  const auto device = open();
  ordered().failing = "dhdStop";
  ordered().failing_times = 1;
  device->releaseForce();
  (void)calls();
  device->write(push());
  EXPECT_THAT(calls(), ElementsAre(kSet, "dhdStop"));
  device->write(push());
  EXPECT_THAT(calls(), IsEmpty());
}

TEST_F(ForceDimensionWrite, WhoeverLetsGoAtAnyTimeFindsNoForceAfterwards) {
  const auto device = open();
  for (int round = 0; round < 200; ++round) {
    std::atomic<bool> done{false};
    std::thread other([&] {
      device->releaseForce();
      done = true;
    });
    while (!done) {
      device->write(push());
      (void)device->read();
      ordered().called = 0;
    }
    other.join();
    device->write(push());
    ASSERT_THAT(ordered().wrench, ElementsAre(0, 0, 0, 0, 0, 0, 0)) << round;
    ASSERT_FALSE(ordered().forces_on) << round;
    device->resumeForce();
    device->write(push());
    ASSERT_THAT(ordered().wrench, ElementsAre(1, 2, 3, 0.01, 0.02, 0.03, 4)) << round;
  }
}

TEST_F(ForceDimensionWrite, NothingInTheTickAllocates) {
  {
    const long before = allocations.load();
    const std::vector<int> some(100);
    EXPECT_GT(allocations.load(), before + static_cast<long>(some[0])) << "the counter counts";
  }
  const auto device = open();
  const long before = allocations.load();
  const auto ticks = [&](int count) {
    for (int i = 0; i < count; ++i) {
      (void)device->read();
      device->write(push());
    }
  };
  ticks(200);
  ordered().forces_on = false;
  ordered().forces_off_cause = 3;
  ticks(200);
  device->releaseForce();
  ticks(60);
  device->resumeForce();
  ordered().frozen = true;
  ticks(200);
  ordered().not_a_number = true;
  ticks(5);
  ordered().not_a_number = false;
  ordered().failing = kPose;
  ticks(20);
  EXPECT_EQ(device->read().state, DeviceState::kLost);
  const long after = allocations.load();
  EXPECT_EQ(after, before);
}

}  // namespace
}  // namespace haptolith

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "program.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// No device's service or SDK is where these tests look, whatever this machine has.
constexpr const char* kNowhere = "/nonexistent/sdk";

json devices() {
  const ProgramResult result = runHaptolith(std::string("devices --json --device-library ") + kNowhere);
  EXPECT_EQ(result.exit_status, 0) << result.errors;
  return json::parse(result.output).at("devices");
}

TEST(DevicesCommand, ListsEveryKindAndWhatToDoAboutThoseThatAreNotThere) {
  std::multiset<std::string> kinds;
  for (const json& device : devices()) {
    EXPECT_EQ(device.size(), 6U) << device;
    const std::string kind = device.at("device");
    kinds.insert(kind);
    EXPECT_THAT(device.at("name").get<std::string>(), Not(IsEmpty())) << kind;
    EXPECT_TRUE(device.at("id").is_string());
    if (device.at("usable").get<bool>()) {
      EXPECT_EQ(device.at("why_not"), "") << kind;
      EXPECT_EQ(device.at("remedy"), "") << kind;
    } else {
      EXPECT_NE(device.at("why_not"), "") << kind;
      EXPECT_NE(device.at("remedy"), "") << kind;
    }
  }
  for (const char* kind :
       {"virtual-hand", "force-dimension", "inverse3", "spacemouse", "gamepad", "mouse", "network"}) {
    EXPECT_GE(kinds.count(kind), 1U) << kind;
    kinds.erase(kind);
  }
  EXPECT_THAT(kinds, IsEmpty());
}

TEST(DevicesCommand, WhatNeedsNoHardwareIsAlwaysThere) {
  for (const json& device : devices()) {
    const std::string kind = device.at("device");
    if (kind == "virtual-hand" || kind == "network") {
      EXPECT_TRUE(device.at("usable")) << kind;
    }
    if (kind == "force-dimension") {
      EXPECT_FALSE(device.at("usable"));
      EXPECT_THAT(device.at("why_not").get<std::string>(), HasSubstr(kNowhere));
    }
  }
}

TEST(DevicesCommand, ItsTextSaysTheSame) {
  EXPECT_THAT(runHaptolith(std::string("devices --library ") + kNowhere).errors,
              HasSubstr("--library is now --device-library"));
  const ProgramResult result = runHaptolith(std::string("devices --device-library ") + kNowhere);
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_THAT(result.output, AllOf(HasSubstr("yes  virtual-hand"), HasSubstr("no   force-dimension"),
                                   HasSubstr(kNowhere), HasSubstr("yes  network"), Not(HasSubstr("\033"))));
  for (const json& device : devices()) {
    if (!device.at("usable").get<bool>()) {
      const std::string remedy = device.at("remedy");
      EXPECT_THAT(result.output, HasSubstr(remedy.substr(0, remedy.find('\n'))));
    }
  }
}

TEST(DevicesCommand, NonsenseIsRefused) {
  EXPECT_EQ(runHaptolith("devices --device mouse").exit_status, 2);
  EXPECT_EQ(runHaptolith("devices everything").exit_status, 2);
}

TEST(RunDevice, WithoutItsSdkTheForceDimensionSaysWhatToDo) {
  const ProgramResult result =
      runHaptolith(std::string("run icra2021 --device force-dimension --duration-s 0.1 --device-library ") + kNowhere);
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.output, IsEmpty());
  EXPECT_THAT(result.errors,
              AllOf(HasSubstr(kNowhere), HasSubstr("SDK"), HasSubstr("forcedimension.com"), HasSubstr("FORCEDIM_SDK")));
}

TEST(RunDevice, AHandsMotionAndADeviceExcludeEachOther) {
  const ProgramResult result = runHaptolith("run icra2021 --device gamepad --motion scoop --duration-s 0.1");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.errors, AllOf(HasSubstr("--device"), HasSubstr("--motion")));
}

TEST(RunDevice, OneThatNobodyKnowsIsRefusedWithThoseThatAreKnown) {
  const ProgramResult result = runHaptolith("run icra2021 --device joystick --duration-s 0.1");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.errors, AllOf(HasSubstr("joystick"), HasSubstr("gamepad"), HasSubstr("force-dimension")));
}

TEST(RunDevice, AnAddressThatIsNoneIsRefused) {
  const ProgramResult result =
      runHaptolith("run icra2021 --device network --device-address nowhere --duration-s 0.1 --no-serve");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.errors, HasSubstr("nowhere"));
}

TEST(RunDevice, ANetworkDeviceThatNobodyHoldsShowsNoForceAndTheRunEnds) {
  const ProgramResult result =
      runHaptolith("run icra2021 --device network --device-address 127.0.0.1:0 --duration-s 0.3 --json");
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json summary = json::parse(result.output);
  EXPECT_EQ(summary.at("force_n").at("max"), 0);
  EXPECT_GE(summary.at("duration_s").get<double>(), 0.3);
  EXPECT_LT(summary.at("duration_s").get<double>(), 0.6);
  EXPECT_EQ(summary.at("ended"), "duration reached");
}

TEST(RunWithADevice, NobodysHandIsPutAtALoopWithoutAClock) {
  const ProgramResult by_option =
      runHaptolith("run icra2021 --no-realtime --device network --device-address 127.0.0.1:0 --no-serve");
  EXPECT_EQ(by_option.exit_status, 2);
  EXPECT_THAT(by_option.errors, AllOf(HasSubstr("real_time"), HasSubstr("network"), HasSubstr("--no-realtime")));

  const fs::path scene = fs::temp_directory_path() / ("haptolith-no-realtime-" + std::to_string(getpid()) + ".toml");
  std::ofstream(scene) << "[loop]\nreal_time = false\n[device]\nkind = \"network\"\naddress = \"127.0.0.1:0\"\n";
  const ProgramResult by_scene = runHaptolith("run --no-serve '" + scene.string() + "'");
  EXPECT_EQ(by_scene.exit_status, 2);
  EXPECT_THAT(by_scene.errors, AllOf(HasSubstr("real_time"), HasSubstr("network")));

  const ProgramResult snapshot = runHaptolith("snapshot '" + scene.string() + "' --out picture.png");
  EXPECT_EQ(snapshot.exit_status, 2);
  EXPECT_THAT(snapshot.errors, AllOf(HasSubstr("network"), HasSubstr("virtual-hand")));
  fs::remove(scene);
}

TEST(RunWithADevice, TheNetworkDeviceListensBeyondThisMachineOnlyWithAKeyOrWhenAskedTo) {
  const std::string everywhere =
      "run icra2021 --device network --device-address 0.0.0.0:0 --no-serve --duration-s 0.01 ";
  const ProgramResult without = runHaptolith(everywhere);
  EXPECT_EQ(without.exit_status, 2);
  EXPECT_THAT(without.errors, AllOf(HasSubstr("--device-key-file"), HasSubstr("--device-insecure")));
  EXPECT_EQ(runHaptolith(everywhere + "--device-insecure").exit_status, 0);

  const ProgramResult lost = runHaptolith(everywhere + "--device-key-file /nowhere/device.key");
  EXPECT_EQ(lost.exit_status, 1);
  EXPECT_THAT(lost.errors, AllOf(HasSubstr("/nowhere/device.key"), HasSubstr("openssl rand -hex 32")));
  const ProgramResult no_key = runHaptolith(everywhere + "--device-key-file /dev/null");
  EXPECT_EQ(no_key.exit_status, 2);
  EXPECT_THAT(no_key.errors, HasSubstr("64 hexadecimal digits"));
  EXPECT_EQ(runInShell("HAPTOLITH_DEVICE_KEY=$(printf 'a%.0s' $(seq 64)) \"$HAPTOLITH\" " + everywhere).exit_status, 0);
}

}  // namespace
}  // namespace haptolith

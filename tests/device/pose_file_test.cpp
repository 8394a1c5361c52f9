#include "haptolith/device/hand/pose_file.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/device/hand/virtual_hand.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kHeader = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
constexpr const char* kTwo = "0,0,0,0.1,1,0,0,0\n1,0.2,0,0.1,1,0,0,0\n";

class PoseFileTest : public testing::Test {
 protected:
  PoseFileTest() : folder_(fs::temp_directory_path() / ("haptolith_poses_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~PoseFileTest() override { fs::remove_all(folder_); }

  fs::path write(const std::string& text) {
    const fs::path path = folder_ / "poses.csv";
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  /// Expects that `text` is refused with a message that names the file, the line and `what`.
  void expectRefused(const std::string& text, int line, const std::string& what) {
    const fs::path path = write(text);
    try {
      (void)PoseFile::read(path);
      ADD_FAILURE() << "read without complaint:\n" << text;
    } catch (const InvalidParameter& error) {
      EXPECT_THAT(error.what(), HasSubstr(path.string() + (line > 0 ? ":" + std::to_string(line) + ":" : "")));
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  }

  fs::path folder_;
};

TEST_F(PoseFileTest, ReadsAGoodFileAndGoesStraightBetweenPoses) {
  const PoseFile poses = PoseFile::read(write(std::string("# recorded by hand\n") + kHeader +
                                              "10,0,0,0.1,1,0,0,0\n\n"
                                              "# a comment between\n"
                                              "12, 0.2, -0.4, 0.1, 0.7071067811865476, 0, 0, 0.7071067811865476\n"));
  EXPECT_EQ(poses.size(), 2U);
  EXPECT_NEAR(poses.duration(), 2, 1e-12);
  EXPECT_LT((poses.at(0).position_m - Vec3(0, 0, 0.1)).norm(), 1e-15);
  EXPECT_LT((poses.at(0.5).position_m - Vec3(0.05, -0.1, 0.1)).norm(), 1e-15);
  // A quarter turn about z in two seconds: 45 degrees after one.
  const Eigen::AngleAxisd halfway(poses.at(1).orientation);
  EXPECT_NEAR(halfway.angle(), std::numbers::pi / 4, 1e-12);
  EXPECT_LT((halfway.axis() - Vec3::UnitZ()).norm(), 1e-12);
}

TEST_F(PoseFileTest, StaysAtTheEnds) {
  const PoseFile poses = PoseFile::read(write(std::string(kHeader) + kTwo));
  EXPECT_EQ(poses.at(-1).position_m, Vec3(0, 0, 0.1));
  EXPECT_EQ(poses.at(1).position_m, Vec3(0.2, 0, 0.1));
  EXPECT_EQ(poses.at(100).position_m, Vec3(0.2, 0, 0.1));
}

TEST_F(PoseFileTest, TakesLineEndsOfWindowsAndAMissingLastOne) {
  const PoseFile poses =
      PoseFile::read(write("t_s,x_m,y_m,z_m,qw,qx,qy,qz\r\n0,0,0,0.1,1,0,0,0\r\n1,0.2,0,0.1,1,0,0,0"));
  EXPECT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses.at(1).position_m, Vec3(0.2, 0, 0.1));
}

TEST_F(PoseFileTest, QuaternionsAreMadeUnitAndTheShortWayIsTaken) {
  const PoseFile poses = PoseFile::read(write(std::string(kHeader) + "0,0,0,0,1.005,0,0,0\n1,0,0,0,-1,0,0,0\n"));
  EXPECT_NEAR(poses.at(0).orientation.norm(), 1, 1e-12);
  EXPECT_NEAR(poses.at(0.5).orientation.angularDistance(Quat::Identity()), 0, 1e-7);  // q and -q are one rotation
}

TEST_F(PoseFileTest, MissingFilesAndFoldersAreRefused) {
  for (const fs::path& path : {folder_ / "nothing.csv", folder_}) {
    try {
      (void)PoseFile::read(path);
      ADD_FAILURE() << path;
    } catch (const InvalidParameter& error) {
      EXPECT_THAT(error.what(), HasSubstr(path.string()));
    }
  }
}

TEST_F(PoseFileTest, TooFewPosesAreRefused) {
  expectRefused("", 0, "nothing in it");
  expectRefused(kHeader, 0, "at least 2");
  expectRefused(std::string(kHeader) + "0,0,0,0,1,0,0,0\n", 0, "at least 2");
}

TEST_F(PoseFileTest, AnotherHeaderIsRefused) {
  expectRefused("0,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n", 1, "t_s,x_m,y_m,z_m,qw,qx,qy,qz");
  expectRefused(std::string("\n# x\nt,x,y,z,qw,qx,qy,qz\n") + kTwo, 3, "header");
}

TEST_F(PoseFileTest, WhatIsNoFiniteNumberIsRefusedWithItsPlace) {
  const std::string good = std::string(kHeader) + kTwo;
  const std::pair<const char*, const char*> rows[] = {{"nan,0,0,0,1,0,0,0", "t_s"},  {"2,inf,0,0,1,0,0,0", "x_m"},
                                                      {"2,0,-inf,0,1,0,0,0", "y_m"}, {"2,0,0,zero,1,0,0,0", "z_m"},
                                                      {"2,0,0,0,1e999,0,0,0", "qw"}, {"2,0,0,0,1,,0,0", "qx"},
                                                      {"2,0,0,0,1,0,0x1,0", "qy"},   {"2,0,0,0,1,0,0,0.1.2", "qz"},
                                                      {"2,0,0,0,1,0,0,NaN", "qz"},   {"2,0 0,0,0,1,0,0,0", "x_m"}};
  for (const auto& [row, column] : rows) {
    expectRefused(good + row + "\n", 4, column);
  }
}

TEST_F(PoseFileTest, TooFewOrTooManyColumnsAreRefused) {
  const std::string good = std::string(kHeader) + kTwo;
  expectRefused(good + "2,0,0,0,1,0,0\n", 4, "8 cells");
  expectRefused(good + "2\n", 4, "8 cells");
  expectRefused(good + "2,0,0,0,1,0,0,0,0\n", 4, "8 cells");
}

TEST_F(PoseFileTest, TimeGoesForward) {
  const std::string good = std::string(kHeader) + kTwo;
  expectRefused(good + "1,0,0,0,1,0,0,0\n", 4, "t_s");
  expectRefused(good + "0.5,0,0,0,1,0,0,0\n", 4, "time goes forward");
}

TEST_F(PoseFileTest, QuaternionsThatAreNoRotationAreRefused) {
  const std::string good = std::string(kHeader) + kTwo;
  expectRefused(good + "2,0,0,0,0,0,0,0\n", 4, "qw,qx,qy,qz");
  expectRefused(good + "2,0,0,0,1,1,0,0\n", 4, "qw,qx,qy,qz");
  expectRefused(good + "2,0,0,0,0.98,0,0,0\n", 4, "qw,qx,qy,qz");
}

TEST_F(PoseFileTest, PositionsFarAwayAreRefused) {
  const std::string good = std::string(kHeader) + kTwo;
  expectRefused(good + "2,0,0,1000,1,0,0,0\n", 4, "z_m");
  expectRefused(good + "2,-10.1,0,0,1,0,0,0\n", 4, "x_m");
}

TEST_F(PoseFileTest, TheVirtualHandFollowsItAndSaysWhenItIsOver) {
  HandParameters parameters;
  parameters.motion = HandMotion::kPoses;
  parameters.compliance = HandCompliance::kRigid;
  parameters.poses_file = write(std::string(kHeader) + kTwo).string();
  VirtualHand hand(parameters, 0.01);
  for (int tick = 1; tick <= 100; ++tick) {
    const DeviceInput now = hand.read();
    EXPECT_NEAR(now.pose.position_m.x(), 0.002 * tick, 1e-12);
    EXPECT_NEAR(now.twist.linear_m_s.x(), 0.2, 1e-9);
    EXPECT_EQ(now.state, DeviceState::kLive) << tick;
  }
  EXPECT_EQ(hand.read().state, DeviceState::kFinished);
}

TEST_F(PoseFileTest, AFileWithoutEndIsRefusedAtOnce) {
  const fs::path link = folder_ / "zero.csv";
  fs::create_symlink("/dev/zero", link);
  EXPECT_THROW((void)PoseFile::read(link), InvalidParameter);
}

TEST_F(PoseFileTest, OfALineWithoutEndOnlyTheBeginningIsReadAndQuoted) {
  const fs::path path = write(kHeader + std::string(kTwo) + "\033[31m" + std::string(10'000'000, 'x'));
  try {
    (void)PoseFile::read(path);
    FAIL();
  } catch (const InvalidParameter& error) {
    const std::string message = error.what();
    EXPECT_THAT(message, HasSubstr(":4: line = '\\u001b[31mxxx"));
    EXPECT_THAT(message, HasSubstr("at most 1000 bytes"));
    EXPECT_LT(message.size(), 400U);
  }
}

TEST_F(PoseFileTest, AWrongNumberIsQuotedWithoutWhatATerminalObeys) {
  expectRefused(kHeader + std::string("0,\033]0;pwned\a,0,0.1,1,0,0,0\n"), 2, "x_m = '\\u001b]0;pwned\\u0007'");
}

}  // namespace
}  // namespace haptolith

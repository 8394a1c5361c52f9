#include "haptolith/lammps/lammps_dump.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

std::string picture(int step, const std::string& heading, const std::string& rows, int count) {
  return "ITEM: TIMESTEP\n" + std::to_string(step) + "\nITEM: NUMBER OF ATOMS\n" + std::to_string(count) +
         "\nITEM: BOX BOUNDS ff ff fm\n-1 1\n-1 1\n0 1\nITEM: ATOMS " + heading + "\n" + rows;
}

class LammpsDump : public testing::Test {
 protected:
  LammpsDump() : path_(std::filesystem::temp_directory_path() / fmt::format("haptolith_dump_{}.lammpstrj", getpid())) {}
  ~LammpsDump() override { std::filesystem::remove(path_); }

  std::filesystem::path with(const std::string& text) const {
    std::ofstream(path_) << text;
    return path_;
  }
  std::string errorOf(const std::string& text, std::optional<std::size_t> number = {}) const {
    try {
      (void)readLammpsDump(with(text), number);
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "nothing";
  }

 private:
  std::filesystem::path path_;
};

constexpr const char* kHeading = "id type x y z radius vx vy vz";

TEST_F(LammpsDump, GivesGrainsInTheOrderOfTheirIds) {
  const LammpsPicture read =
      readLammpsDump(with(picture(400, kHeading, "2 3 0.1 0.2 0.3 0.004 0 0 0\n1 1 -0.1 -0.2 1e-2 0.005 1 2 3\n", 2)));
  EXPECT_EQ(read.step, 400);
  EXPECT_EQ(read.number, 1U);
  ASSERT_EQ(read.grains.size(), 2U);
  EXPECT_EQ(read.grains[0].id, 1);
  EXPECT_EQ(read.grains[0].type, 1);
  EXPECT_EQ(read.grains[0].centre_m, Vec3(-0.1, -0.2, 0.01));
  EXPECT_EQ(read.grains[0].radius_m, 0.005);
  EXPECT_EQ(read.grains[1].type, 3);
}

TEST_F(LammpsDump, ReadsColumnsByTheirNames) {
  const LammpsPicture read = readLammpsDump(with(picture(0, "radius z y x id", "0.004 3 2 1 7\n", 1)));
  EXPECT_EQ(read.grains[0].centre_m, Vec3(1, 2, 3));
  EXPECT_EQ(read.grains[0].id, 7);
  EXPECT_EQ(read.grains[0].type, 1);
  EXPECT_EQ(read.grains[0].radius_m, 0.004);
}

TEST_F(LammpsDump, TakesTheGrainsOwnRadii) {
  for (const char* heading : {"id x y z radius v_radius", "id x y z v_radius radius"}) {
    const bool last = std::string(heading).ends_with(" v_radius");
    const std::string row = last ? "1 0 0 0 0.003 0.004\n" : "1 0 0 0 0.004 0.003\n";
    EXPECT_EQ(readLammpsDump(with(picture(0, heading, row, 1))).grains[0].radius_m, 0.004) << heading;
  }
}

TEST_F(LammpsDump, GivesTheLastThatIsWhole) {
  const std::string two =
      picture(0, kHeading, "1 1 0 0 1 0.004 0 0 0\n", 1) + picture(100, kHeading, "1 1 0 0 2 0.004 0 0 0\n", 1);
  EXPECT_EQ(readLammpsDump(with(two)).step, 100);
  EXPECT_EQ(readLammpsDump(with(two), 1).step, 0);
  const std::string cut = two +
                          "ITEM: TIMESTEP\n200\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n"
                          "ITEM: ATOMS id type x y z radius\n1 1 0 0 3 0.004\n";
  EXPECT_EQ(readLammpsDump(with(cut)).step, 100);
  EXPECT_THAT(errorOf(two, 3), HasSubstr("has 2 complete frames"));
}

TEST_F(LammpsDump, RefusesWhatIsNone) {
  EXPECT_THAT(errorOf("x,y,z\n1,2,3\n"), HasSubstr("ITEM:"));
  EXPECT_THAT(errorOf(picture(0, "id x y z", "1 0 0 0\n", 1)), HasSubstr("with a column radius"));
  EXPECT_THAT(errorOf(picture(0, kHeading, "1 1 0 nan 0 0.004 0 0 0\n", 1)), HasSubstr("finite number"));
  EXPECT_THAT(errorOf(picture(0, kHeading, "1 1 0 1e400 0 0.004 0 0 0\n", 1)), HasSubstr("finite number"));
  EXPECT_THAT(errorOf(picture(0, kHeading, "1 1 0\n", 1)), HasSubstr("as many numbers"));
  EXPECT_THAT(errorOf(picture(0, kHeading, "", -1)), HasSubstr("0 to"));
  EXPECT_THAT(errorOf(picture(0, kHeading, "", 0)), HasSubstr("without a grain"));
  EXPECT_THAT(errorOf(picture(0, kHeading, "1 1 0 0 0 0 0 0 0\n", 1)), HasSubstr("radius above 0"));
  EXPECT_THAT(errorOf(picture(0, kHeading, "7 1 0 0 0 1 0 0 0\n7 1 0 0 3 1 0 0 0\n", 2)), HasSubstr("id 7 twice"));
  EXPECT_THAT(errorOf("ITEM: UNITS\nlj\n" + picture(0, kHeading, "1 1 0 0 1 0.004 0 0 0\n", 1)), HasSubstr("si"));
  EXPECT_THAT(errorOf(""), HasSubstr("at least one"));
}

TEST_F(LammpsDump, CanBeInterrupted) {
  EXPECT_THROW((void)readLammpsDump(with(picture(0, kHeading, "1 1 0 0 1 0.004 0 0 0\n", 1)), {},
                                    [](std::size_t) { return false; }),
               Failure);
}

}  // namespace
}  // namespace haptolith

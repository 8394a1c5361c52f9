#include "haptolith/teleop/link/link_profiles.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "haptolith/teleop/link/link.h"

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(LinkProfiles, AreLinksByTheirNames) {
  double before_s = 0;
  for (const LinkProfile& profile : linkProfiles()) {
    EXPECT_EQ(&findLinkProfile(profile.name), &profile);
    EXPECT_NO_THROW(Link{profile.up});
    EXPECT_NO_THROW(Link{profile.down});
    EXPECT_NE(profile.up.seed, profile.down.seed) << "else both lose the same packets";
    EXPECT_GE(profile.roundTrip(), before_s) << "the quickest first";
    EXPECT_FALSE(profile.what.empty());
    before_s = profile.roundTrip();
  }
  EXPECT_EQ(linkProfiles().size(), 7U);
}

TEST(LinkProfiles, HaveTheRoundTripsThatTheyAreKnownFor) {
  EXPECT_DOUBLE_EQ(findLinkProfile("gateway").roundTrip(), 0.4);
  EXPECT_DOUBLE_EQ(findLinkProfile("iss-relay").roundTrip(), 0.85);
  EXPECT_DOUBLE_EQ(findLinkProfile("earth-moon").roundTrip(), 2.6);
  EXPECT_DOUBLE_EQ(findLinkProfile("earth-moon-relay").roundTrip(), 5);
  EXPECT_NEAR(findLinkProfile("earth-moon-relay").up.meanLoss(), 0.03, 1e-12);
  // Light over 384 400 km, round trip.
  EXPECT_GT(findLinkProfile("earth-moon").roundTrip(), 2 * 384.4e6 / 299792458.0);
}

TEST(LinkProfiles, ARefusalNamesThem) {
  try {
    (void)findLinkProfile("mars");
    FAIL();
  } catch (const InvalidParameter& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("'mars'"), HasSubstr("earth-moon-relay"), HasSubstr("lan")));
  }
}

class Delays : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }

  std::vector<DelayAt> read(const std::string& text) {
    std::ofstream(file_) << text;
    return readDelays(file_);
  }
  std::string refusal(const std::string& text) {
    try {
      (void)read(text);
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "taken";
  }

  std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) / ("haptolith-delays-" + std::to_string(getpid()) + ".csv");
};

TEST_F(Delays, AreReadFromATable) {
  const std::vector<DelayAt> expected{{0, 0.6}, {1.5, 0.72}, {3, 1e-3}};
  EXPECT_EQ(read("t_s,delay_s\n0,0.6\n1.5,0.72\n3,1e-3\n"), expected);
  EXPECT_EQ(read("t_s,delay_s\r\n0,0.6\r\n1.5,0.72\r\n3,1e-3"), expected) << "as Windows writes it";
}

TEST_F(Delays, MayBeOfAnyClock) {
  const std::vector<DelayAt> expected{{0, 0.5}, {1.5, 0.75}};
  EXPECT_EQ(read("t_s,delay_s\n1764288000.25,0.5\n1764288001.75,0.75\n"), expected);
  EXPECT_EQ(read("t_s,delay_s\n1764288000250000000,0.5\n1764288001750000000,0.75\n"), expected);
  EXPECT_EQ(read("t_s,delay_s\n-1,0.5\n0.5,0.75\n"), expected);
  const std::vector<DelayAt> later{{5, 0.5}, {6.5, 0.75}};
  EXPECT_EQ(read("delay_s;T_S;who\n0,5;5;me\n0,75;6,5;me\n"), later) << "the link's own clock";
}

TEST_F(Delays, ARefusalSaysWhere) {
  EXPECT_THAT(refusal(""), HasSubstr("nothing in it"));
  EXPECT_THAT(refusal("t_s,delay_s\n"), HasSubstr("table of delays"));
  EXPECT_THAT(refusal("time,delay\n0,1\n"), AllOf(HasSubstr(":1"), HasSubstr("t_s,delay_s")));
  EXPECT_THAT(refusal("t_s,delay_s\n0,1\n1\n"), AllOf(HasSubstr(":3"), HasSubstr("'1'")));
  EXPECT_THAT(refusal("t_s,delay_s\n0,1,2\n"), HasSubstr(":2"));
  EXPECT_THAT(refusal("t_s,delay_s\n0,nan\n"), HasSubstr(":2"));
  EXPECT_THAT(refusal("t_s,delay_s\n0,-1\n"), HasSubstr("0 to 600"));
  EXPECT_THAT(refusal("t_s,delay_s\n1,1\n1,2\n"), HasSubstr("later than 1 s, the time in line 2"));
  EXPECT_THROW((void)readDelays("/nonexistent/delays.csv"), InvalidParameter);
}

}  // namespace
}  // namespace haptolith

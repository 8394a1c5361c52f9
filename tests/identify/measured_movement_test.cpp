#include "haptolith/identify/measured_movement.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace haptolith {
namespace {

using testing::HasSubstr;

const ToolMovement kMovement({{0, {}}, {1, {{0.1, 0, 0}, Quat::Identity()}}, {2, {{0.1, 0, -0.05}, Quat::Identity()}}});

/// The movement from `begin_s` on, with a force that is the window's number.
std::vector<MeasuredSample> made(double begin_s, const Vec3& origin_m, double step_s = 0.01) {
  std::vector<MeasuredSample> samples;
  for (int i = 0; i * step_s < 5; ++i) {
    const double time_s = i * step_s;
    const Pose pose = kMovement.at(time_s - begin_s);
    samples.push_back(
        {time_s, {pose.position_m + origin_m, pose.orientation}, Vec3(std::floor((time_s - begin_s) / 0.25), 0, 1)});
  }
  return samples;
}

TEST(MatchForces, FindsWhenItBegan) {
  const MatchedForces matched = matchForces(kMovement, made(1.5, {1, 2, 3}), {1, 2, 3});
  EXPECT_NEAR(matched.begin_s, 1.5, 0.03);
  EXPECT_EQ(matched.windows, 8U);
  for (std::size_t window = 0; window < 8; ++window) {
    EXPECT_NEAR(matched.forces[window]->x(), static_cast<double>(window), 0.15);
  }
}

TEST(MatchForces, LeavesOutWhereTheToolWasElsewhere) {
  std::vector<MeasuredSample> samples = made(1, Vec3::Zero());
  for (MeasuredSample& sample : samples) {
    if (sample.time_s > 1.9 && sample.time_s < 2.1) {
      sample.pose.position_m.z() += 0.005;  // stuck
    }
    if (sample.time_s > 2.6 && sample.time_s < 2.7) {
      sample.pose.orientation = Quat(Eigen::AngleAxisd(0.1, Vec3::UnitX()));
    }
  }
  const MatchedForces matched = matchForces(kMovement, samples, Vec3::Zero());
  EXPECT_EQ(matched.windows, 5U);
  EXPECT_FALSE(matched.forces[3] || matched.forces[4] || matched.forces[6]);
}

TEST(MatchForces, FindsNothingWhereThereIsNothing) {
  EXPECT_EQ(matchForces(kMovement, made(1, Vec3::Zero()), {0, 0.01, 0}).windows, 0U) << "10 mm beside it";
  EXPECT_EQ(matchForces(kMovement, made(1, Vec3::Zero(), 0.2), Vec3::Zero()).windows, 0U) << "too seldom";
}

TEST(MatchForces, TakesNoTimeForTimeWithoutSamples) {
  std::vector<MeasuredSample> samples = made(1.5, Vec3::Zero());
  const MatchedForces expected = matchForces(kMovement, samples, Vec3::Zero());
  std::vector<MeasuredSample> gap = samples;
  gap.push_back(samples.back());
  gap.back().time_s = 5e9;  // at one place each 0.02 s: years
  EXPECT_EQ(matchForces(kMovement, gap, Vec3::Zero()).forces, expected.forces);
  gap = samples;
  gap.insert(gap.begin(), samples.front());
  gap.front().time_s = -5e9;
  const MatchedForces late = matchForces(kMovement, gap, Vec3::Zero());
  EXPECT_EQ(late.windows, 8U);
  EXPECT_NEAR(late.begin_s, expected.begin_s, 0.03);
}

TEST(MatchForces, FindsAMovementByTheClockOfACalendar) {
  std::vector<MeasuredSample> samples = made(1.5, Vec3::Zero());
  for (MeasuredSample& sample : samples) {
    sample.time_s += 1764288000;
  }
  const MatchedForces matched = matchForces(kMovement, samples, Vec3::Zero());
  EXPECT_EQ(matched.windows, 8U);
  EXPECT_NEAR(matched.begin_s, 1764288001.5, 0.03);
}

TEST(MatchForces, GivesUpAtOnceWhereRowsAreTooFarApart) {
  std::vector<MeasuredSample> samples = made(1.5, Vec3::Zero());
  for (MeasuredSample& sample : samples) {
    sample.time_s *= 1e8;  // each 1e6 s; no place would be tried in less than a minute
  }
  EXPECT_EQ(matchForces(kMovement, samples, Vec3::Zero()).windows, 0U);
}

TEST(MatchForces, TakesWhatThereIsOfAMovement) {
  std::vector<MeasuredSample> samples = made(1, Vec3::Zero());
  std::erase_if(samples, [](const MeasuredSample& sample) { return sample.time_s > 2; });
  EXPECT_EQ(matchForces(kMovement, samples, Vec3::Zero()).windows, 4U);
}

/// The first second of the movement, and the second one.
const std::vector<MovementPart> kParts{
    {"along", 0, 4, ToolMovement({{0, {}}, {1, {{0.1, 0, 0}, Quat::Identity()}}})},
    {"down", 4, 4, ToolMovement({{0, {{0.1, 0, 0}, Quat::Identity()}}, {1, {{0.1, 0, -0.05}, Quat::Identity()}}})}};

/// The samples between two times, shifted in time.
std::vector<MeasuredSample> stretch(std::vector<MeasuredSample> samples, double from_s, double to_s, double later_s) {
  std::erase_if(samples, [&](const MeasuredSample& s) { return s.time_s < from_s || s.time_s > to_s; });
  for (MeasuredSample& sample : samples) {
    sample.time_s += later_s;
  }
  return samples;
}

TEST(MatchParts, FindsThemInWhateverOrder) {
  const std::vector<MeasuredSample> whole = made(1, Vec3::Zero());
  std::vector<MeasuredSample> course = stretch(whole, 1.95, 3.1, 0);
  const std::vector<MeasuredSample> first = stretch(whole, 0.9, 1.99, 10);
  course.insert(course.end(), first.begin(), first.end());
  const MatchedParts matched = matchParts(kMovement, kParts, {course}, Vec3::Zero());
  EXPECT_EQ(matched.windows, 8U);
  EXPECT_NEAR(matched.parts[0].begin_s, 11, 0.03);
  EXPECT_NEAR(matched.parts[1].begin_s, 2, 0.03);
  for (std::size_t window = 0; window < 8; ++window) {
    EXPECT_NEAR(matched.forces[window]->x(), static_cast<double>(window), 0.15);
  }
}

TEST(MatchParts, FindsThemInSeveralCourses) {
  const std::vector<MeasuredSample> whole = made(1, Vec3::Zero());
  std::vector<MeasuredSample> again = stretch(whole, 0, 2.05, 0);  // in soil that was touched
  for (MeasuredSample& sample : again) {
    sample.force_n.x() += 100;
  }
  const MatchedParts matched =
      matchParts(kMovement, kParts, {stretch(whole, 0, 2.05, 5), again, stretch(whole, 1.95, 5, 7)}, Vec3::Zero());
  EXPECT_EQ(matched.windows, 8U);
  EXPECT_EQ(matched.parts[0].course, 0U);
  EXPECT_EQ(matched.parts[1].course, 2U);
  EXPECT_NEAR(matched.forces[2]->x(), 2, 0.15);
  const MatchedParts one = matchParts(kMovement, kParts, {stretch(whole, 1.95, 5, 7)}, Vec3::Zero());
  EXPECT_EQ(one.parts[0].windows, 0U);
  EXPECT_EQ(one.windows, 4U);
}

TEST(MatchParts, IsMatchForcesOfAWholeMovement) {
  const std::vector<MeasuredSample> whole = made(1.37, {1, 2, 3});
  EXPECT_EQ(matchParts(kMovement, kParts, {whole}, {1, 2, 3}).forces, matchForces(kMovement, whole, {1, 2, 3}).forces);
}

class ReadMeasured : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }

  std::vector<MeasuredSample> read(const std::string& text) {
    std::ofstream(file_) << text;
    return readMeasured(file_);
  }
  std::string refusal(const std::string& text) {
    try {
      (void)read(text);
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "taken";
  }

  static constexpr const char* kHeader = "tick_us,t_s,x_m,y_m,z_m,qw,qx,qy,qz,soil_fx_n,soil_fy_n,soil_fz_n\n";
  std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) / ("haptolith-measured-" + std::to_string(getpid()) + ".csv");
};

TEST_F(ReadMeasured, TakesItsColumnsWhereverTheyAre) {
  const auto samples = read(std::string(kHeader) + "x,0,1,2,3,1,0,0,0,4,5,6\ny,0.5,1,2,3,0,1,0,0,7,8,9\n");
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[1].time_s, 0.5);
  EXPECT_EQ(samples[0].pose.position_m, Vec3(1, 2, 3));
  EXPECT_EQ(samples[1].force_n, Vec3(7, 8, 9));
}

TEST_F(ReadMeasured, TakesAnExportedRecording) {
  const auto samples = read(
      "# an export\nt_s,x_m,tool_x_m,tool_y_m,tool_z_m,tool_qw,tool_qx,tool_qy,tool_qz,soil_fx_n,soil_fy_n,soil_fz_n\n"
      "0,9,1,2,3,1,0,0,0,4,5,6\n1,9,1,2,3,1,0,0,0,4,5,6\n");
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].pose.position_m, Vec3(1, 2, 3));
}

TEST_F(ReadMeasured, TakesTimeOfAnyClock) {
  const std::string row = ",1,2,3,1,0,0,0,4,5,6\n";
  const std::string header = "t_s,x_m,y_m,z_m,qw,qx,qy,qz,soil_fx_n,soil_fy_n,soil_fz_n\n";
  EXPECT_EQ(read(header + "1764288000.25" + row + "1764288000.5" + row)[1].time_s, 1764288000.5);
  EXPECT_EQ(read(header + "1764288000250000000" + row + "1764288000500000000" + row)[1].time_s, 1764288000.5);
  EXPECT_EQ(read(header + "-2e6" + row + "2e6" + row)[1].time_s, 2e6);
}

TEST_F(ReadMeasured, SaysWhatIsWrong) {
  EXPECT_THAT(refusal("t_s,x_m\n0,0\n1,1\n"), HasSubstr("columns t_s,x_m,y_m,z_m,qw,qx,qy,qz,soil_fx_n"));
  EXPECT_THAT(refusal(std::string(kHeader) + "0,0,1,2,3,1,0,0,0,4,5,6\n"), HasSubstr("two or more"));
  EXPECT_THAT(refusal(std::string(kHeader) + "0,0,1,2,3,1,0,0,0,4,5,6\n0,0,1,2,3,1,0,0,0,4,5,6\n"),
              HasSubstr("time goes forward"));
  EXPECT_THAT(refusal(std::string(kHeader) + "0,0,1,2,3,2,0,0,0,4,5,6\n"), HasSubstr("length of qw,qx,qy,qz"));
  EXPECT_THAT(refusal(std::string(kHeader) + "0,0,1,2,3,1,0,0,0,4,5,nan\n"), HasSubstr(":2: column soil_fz_n"));
  EXPECT_THAT(refusal(std::string(kHeader) + "0,0,1,2,3,1,0,0,0,4,5,1e9\n"), HasSubstr("-1000000 to 1000000"));
}

}  // namespace
}  // namespace haptolith

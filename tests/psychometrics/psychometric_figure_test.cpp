#include "haptolith/psychometrics/psychometric_figure.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class PsychometricFigureTest : public testing::Test {
 protected:
  PsychometricFigureTest() { fs::create_directories(folder_); }
  ~PsychometricFigureTest() override { fs::remove_all(folder_); }

  static Fit someFit(double k) {
    FitOptions options = weberOptions(1.6);
    options.simulations = 0;
    return fitPsychometric(std::vector<Level>{{0.3, k, 24}, {1, 8, 24}, {4, 20, 24}, {10, 23, 24}}, options);
  }
  std::string drawn(const PsychometricFigure& wanted, const char* name = "figure.svg") const {
    drawPsychometricFigure(folder_ / name, wanted);
    std::ostringstream text;
    text << std::ifstream(folder_ / name, std::ios::binary).rdbuf();
    return text.str();
  }

  const fs::path folder_ = fs::temp_directory_path() / ("haptolith-psychometric-figure-" + std::to_string(getpid()));
};

TEST_F(PsychometricFigureTest, ShowsPeopleGroupAndReference) {
  const std::string svg = drawn({.title = "It's a title",
                                 .x_label = "gravity / (m/s²)",
                                 .log_axis = true,
                                 .reference = 1.6,
                                 .group = FigureCurve{"everybody", someFit(3)},
                                 .participants = {{"S01", someFit(2)}, {"S02", someFit(5)}}});
  for (const char* text : {"It's a title", "everybody", "S01", "S02", "JND", "reference", "</svg>"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST_F(PsychometricFigureTest, OfOnePersonOnALinearAxisIsDrawnAsPng) {
  const std::string png = drawn({.x_label = "x", .participants = {{"S01", someFit(2)}}}, "figure.png");
  EXPECT_THAT(png, testing::StartsWith("\x89PNG"));
}

TEST_F(PsychometricFigureTest, NonsenseIsRefused) {
  EXPECT_THROW(drawn({}), InvalidParameter);
  PsychometricFigure below_zero{.log_axis = true, .participants = {{"S01", someFit(2)}}};
  below_zero.reference = -1;
  EXPECT_THROW(drawn(below_zero), InvalidParameter);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST(WilsonInterval, IsTheTextbooks) {
  // 1 of 10 at 95 %: 0.0179 to 0.4042 (Newcombe 1998, Statistics in Medicine 17, 857, table I has 0.0179 and 0.4042).
  const Interval interval = wilsonInterval(1, 10, 0.95);
  EXPECT_NEAR(interval.low, 0.0179, 1e-4);
  EXPECT_NEAR(interval.high, 0.4042, 1e-4);
  EXPECT_EQ(wilsonInterval(0, 3, 0.95).low, 0);
  EXPECT_EQ(wilsonInterval(3, 3, 0.95).high, 1);
  EXPECT_THROW((void)wilsonInterval(0, 0, 0.95), InvalidParameter);
}

}  // namespace
}  // namespace haptolith

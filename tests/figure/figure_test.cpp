#include "haptolith/figure/figure.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;

class FigureTest : public testing::Test {
 protected:
  FigureTest() { fs::create_directories(folder_); }
  ~FigureTest() override { fs::remove_all(folder_); }

  static std::string textOf(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  std::size_t filesInFolder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  void draw(const fs::path& path) const {
    Figure figure(path, 400, 300);
    figure.data("points", {{0, 1}, {1, 2}, {2, std::nan("")}, {3, 1}});
    figure.command("plot $points using 1:2 with lines title 'a line'");
    figure.save();
  }

  const fs::path folder_ = fs::temp_directory_path() / ("haptolith-figure-test-" + std::to_string(getpid()));
};

TEST_F(FigureTest, SvgIsDrawnWhole) {
  draw(folder_ / "a figure's name.svg");
  const std::string svg = textOf(folder_ / "a figure's name.svg");
  EXPECT_THAT(svg, testing::StartsWith("<?xml"));
  EXPECT_THAT(svg, testing::HasSubstr("a line"));
  EXPECT_THAT(svg, testing::HasSubstr("</svg>"));
  EXPECT_EQ(filesInFolder(), 1u);
}

TEST_F(FigureTest, PngIsDrawnWhole) {
  draw(folder_ / "figure.PNG");
  EXPECT_THAT(textOf(folder_ / "figure.PNG"), testing::StartsWith("\x89PNG"));
}

TEST_F(FigureTest, IsTheSameEveryTime) {
  draw(folder_ / "one.svg");
  draw(folder_ / "two.svg");
  EXPECT_EQ(textOf(folder_ / "one.svg"), textOf(folder_ / "two.svg"));
}

TEST_F(FigureTest, ErrorsOfGnuplotAreToldAndLeaveNothingBehind) {
  try {
    Figure figure(folder_ / "figure.svg", 400, 300);
    figure.command("plot sin(x) with nonsense");
    for (int i = 0; i < 10000; ++i) {  // more than a pipe would hold after gnuplot has gone
      figure.command("set title 'a command that gnuplot will never read'");
    }
    figure.save();
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_THAT(failure.what(), testing::HasSubstr("figure.svg"));
    EXPECT_THAT(failure.what(), testing::HasSubstr("with nonsense"));
  }
  EXPECT_EQ(filesInFolder(), 0u);
}

TEST_F(FigureTest, UnsavedFiguresLeaveNothingBehind) {
  { Figure figure(folder_ / "figure.svg", 400, 300); }
  EXPECT_EQ(filesInFolder(), 0u);
}

TEST_F(FigureTest, OtherFormatsAreRefused) {
  for (const char* name : {"figure.pdf", "figure", "svg"}) {
    EXPECT_THROW(Figure(folder_ / name, 400, 300), InvalidParameter) << name;
  }
}

TEST_F(FigureTest, MissingFoldersAreToldByName) {
  try {
    Figure(folder_ / "missing" / "figure.svg", 400, 300);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_THAT(failure.what(), testing::HasSubstr("missing/figure.svg"));
  }
}

TEST_F(FigureTest, MissingGnuplotIsToldWithTheRemedy) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", folder_.c_str(), 1);
  try {
    Figure(folder_ / "figure.svg", 400, 300);
    ADD_FAILURE();
  } catch (const Failure& failure) {
    EXPECT_STREQ(failure.what(), "gnuplot is not installed: apt install gnuplot-nox");
  }
  setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace haptolith

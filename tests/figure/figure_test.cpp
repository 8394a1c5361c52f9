#include "haptolith/figure/figure.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <regex>
#include <sstream>
#include <string>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/child_process.h"

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

/// The text that an .svg shows, with what XML escapes.
std::string shownBy(const std::string& svg) {
  std::string shown = std::regex_replace(svg, std::regex("<[^>]*>"), "");
  for (const auto& [escape, letter] : {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}}) {
    shown = std::regex_replace(shown, std::regex(escape), letter);
  }
  return shown;
}

TEST_F(FigureTest, NoTextOfAFileBecomesACommand) {
  const fs::path pwned = folder_ / "pwned";
  const std::string command = fmt::format("system('touch {0}')\nsystem(\"touch {0}\")", pwned.string());
  const std::string substituted = fmt::format("`touch {0}` @`touch {0}` $(touch {0})", pwned.string());
  for (const std::string& text : {"A nice scene\n" + command + "\n#", "it's\r" + command, "\\\n" + command,
                                  "'\n" + command + "\n'", "''\n" + command, std::string("a\0\n", 3) + command,
                                  substituted, "'." + substituted + ".'", std::string("\"\n") + command}) {
    Figure figure(folder_ / "figure.svg", 400, 300);
    figure.command(fmt::format("set title {0}\nset xlabel {0}\nplot x title {0}", gnuplotQuoted(text)));
    figure.save();
    EXPECT_FALSE(fs::exists(pwned)) << text;
    fs::remove(folder_ / "figure.svg");
  }
}

TEST_F(FigureTest, EveryByteStaysInsideItsString) {
  for (int byte = 0; byte < 256; ++byte) {
    for (const char* const after : {"", "\n", "'", "\\"}) {
      const std::string quoted = gnuplotQuoted(std::string(1, static_cast<char>(byte)) + after);
      ASSERT_TRUE(quoted.size() >= 2 && quoted.front() == '\'' && quoted.back() == '\'');
      const std::string inside = quoted.substr(1, quoted.size() - 2);
      EXPECT_TRUE(std::ranges::none_of(inside, [](unsigned char c) { return c < 0x20 || c == 0x7F; })) << byte;
      EXPECT_THAT(inside, testing::Not(testing::HasSubstr("'"))) << byte;
    }
  }
}

TEST_F(FigureTest, MarksOfEnhancedTextAreShownAsTheyAre) {
  const std::string text = R"(a_b^c {/:Bold d} @e &{f} ~g.h \u1F60 \101 {/"x"y:<b>} it's 100 % `z`)";
  Figure figure(folder_ / "figure.svg", 800, 300);
  figure.command(fmt::format("unset tics\nplot x title {}", gnuplotQuoted(text)));
  figure.save();
  EXPECT_THAT(shownBy(textOf(folder_ / "figure.svg")), testing::HasSubstr(text));
}

TEST_F(FigureTest, TextWithoutMarksIsShownAsItIs) {
  for (const std::string text : {"The paper's scene", R"(C:\dir\new)", "plain"}) {
    Figure figure(folder_ / "figure.svg", 800, 300);
    figure.command(fmt::format("unset tics\nset title {} font ',20'\nplot x notitle", gnuplotQuoted(text)));
    figure.save();
    EXPECT_THAT(shownBy(textOf(folder_ / "figure.svg")), testing::HasSubstr("\t" + text + "\n"));
    fs::remove(folder_ / "figure.svg");
  }
}

TEST_F(FigureTest, TextWithoutAnEndIsCut) {
  EXPECT_LT(gnuplotQuoted(std::string(100'000'000, 'x')).size(), 2 * kFigureTextLetters);
}

TEST_F(FigureTest, AFileNamedLikeACommandIsAFile) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  fs::create_directory("|touch pwned; cat >a");
  draw("|touch pwned; cat >a/figure.svg");
  EXPECT_THAT(textOf("|touch pwned; cat >a/figure.svg"), testing::HasSubstr("</svg>"));
  EXPECT_FALSE(fs::exists("pwned"));
  fs::current_path(before);
}

TEST_F(FigureTest, NamesOfDataAreWords) {
  Figure figure(folder_ / "figure.svg", 400, 300);
  EXPECT_THROW(figure.data("a\nsystem('id')", {{0, 1}}), InvalidParameter);
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

TEST_F(FigureTest, AGnuplotThatDoesNotEndIsKilledWithUs) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const Descriptor from(open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  const pid_t us = fork();
  if (us == 0) {  // another one of us
    Figure figure(folder_ / "figure.svg", 400, 300);
    figure.command(fmt::format("set print '{}'\nprint 'drawing'\nwhile (1) {{ x = 1 }}", pipe.string()));
    figure.save();
    _exit(0);
  }
  const std::function<bool()> never;
  const Deadline deadline{.until = std::chrono::steady_clock::now() + std::chrono::minutes(1), .stopped = never};
  std::string said;
  ASSERT_TRUE(readSome(from, said, deadline));
  EXPECT_EQ(said, "drawing\n");
  kill(us, SIGKILL);
  waitpid(us, nullptr, 0);
  EXPECT_FALSE(readSome(from, said, deadline)) << "gnuplot has closed its end";
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

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "program.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kInstrumented = true;
#else
constexpr bool kInstrumented = false;
#endif

class SnapshotCommand : public testing::Test {
 protected:
  SnapshotCommand() { fs::create_directories(temporary_); }
  ~SnapshotCommand() override { fs::remove_all(folder_); }

  /// Runs `haptolith snapshot ARGUMENTS --out FOLDER/NAME`; `settings` may be variables, as a shell takes them.
  [[nodiscard]] ProgramResult snapshot(const std::string& name, const std::string& arguments = "",
                                       const std::string& settings = "") const {
    return runInShell(fmt::format("TMPDIR='{}' {} \"$HAPTOLITH\" snapshot icra2021 {} --out '{}'", temporary_.string(),
                                  settings, arguments, (folder_ / name).string()));
  }

  /// Number of files in the folder, without the folder for temporary files, which has to be empty.
  [[nodiscard]] std::size_t files() const {
    for (const fs::directory_entry& left : fs::recursive_directory_iterator(temporary_)) {
      ADD_FAILURE() << left.path() << " is left";
    }
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator())) - 1;
  }

  [[nodiscard]] std::string contentOf(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  /// Whether real pictures can be asked for here; a sanitized Chromium would take minutes.
  [[nodiscard]] static bool canDraw(const char* also = "true") {
    return !kInstrumented &&
           std::system(fmt::format("command -v chromium > /dev/null && command -v {} > /dev/null", also).c_str()) == 0;
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / fmt::format("haptolith_snapshot_{}", getpid());
  const fs::path temporary_ = folder_ / "tmp";
};

TEST_F(SnapshotCommand, WrongOptionsAreUsageErrors) {
  const auto refused = [this](const std::string& name, const std::string& arguments, const std::string& why) {
    const ProgramResult result = snapshot(name, arguments);
    EXPECT_EQ(result.exit_status, 2) << arguments;
    EXPECT_THAT(result.errors, HasSubstr(why)) << arguments;
    EXPECT_EQ(files(), 0U) << arguments;
  };
  refused("view.jpg", "", "must be a file name ending in .png");
  refused("view.mp4", "", "with --film in .mp4 or .webm");
  refused("view.png", "--film", "must be a file name ending in .mp4 or .webm");
  refused("view.mp4", "--film --width 641", "must be even for a film");
  refused("view.png", "--width 319", "319 is not valid: must be a whole number, 320 to 7680");
  refused("view.png", "--height 4321", "4321 is not valid: must be a whole number, 240 to 4320");
  refused("view.png", "--at-s -1", "--at-s");
  refused("view.png", "--fps 30", "--fps requires --film");
  refused("view.png", "--drawing cubes", "must be grains or balls");
  refused("view.png", "--colour pink", "must be plain, force, speed, depth or sleep");
  refused("view.png", "--view below", "must be front, side, top or three-quarter");
  refused("view.png", "--panels --no-panels", "cannot both be given");
  refused("view.png", "--preset P9", "must be one of P1");
  EXPECT_EQ(runHaptolith("snapshot").exit_status, 2);
}

TEST_F(SnapshotCommand, FoldersThatAreNotThereAreTold) {
  const ProgramResult result = snapshot("missing/view.png");
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, HasSubstr("missing/view.png: No such file or directory"));
}

TEST_F(SnapshotCommand, AMissingChromiumIsToldWithTheRemedy) {
  for (const char* setting : {"PATH=/nowhere", "HAPTOLITH_CHROMIUM=/nonexistent"}) {
    const ProgramResult result = snapshot("view.png", "", setting);
    EXPECT_EQ(result.exit_status, 1);
    EXPECT_THAT(result.errors, HasSubstr("apt install chromium\n")) << setting;
    EXPECT_EQ(files(), 0U);
  }
}

TEST_F(SnapshotCommand, AMissingFfmpegIsToldWithTheRemedy) {
  const ProgramResult result = snapshot("film.mp4", "--film", "PATH=/nowhere");
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, HasSubstr("ffmpeg is not installed: apt install ffmpeg\n"));
  EXPECT_EQ(files(), 0U);
}

TEST_F(SnapshotCommand, AChromiumThatEndsAtOnceIsTold) {
  const ProgramResult result = snapshot("view.png", "", "HAPTOLITH_CHROMIUM=/bin/false");
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, HasSubstr("Chromium has ended"));
  EXPECT_EQ(files(), 0U);
}

TEST_F(SnapshotCommand, DrawsAPictureThatShowsSomething) {
  if (!canDraw()) {
    GTEST_SKIP() << "no chromium, or instrumented code";
  }
  const ProgramResult result = snapshot("view.png", "--at-s 0.1 --width 400 --height 300 --no-panels");
  if (result.errors.find("built without its page") != std::string::npos) {
    GTEST_SKIP() << "no page in this build";
  }
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_EQ(files(), 1U);
  const std::string png = contentOf("view.png");
  EXPECT_THAT(png, StartsWith("\x89PNG\r\n\x1a\n"));
  const auto number = [&png](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      value = value << 8 | static_cast<unsigned char>(png.at(at + i));
    }
    return value;
  };
  EXPECT_EQ(number(16), 400U);
  EXPECT_EQ(number(20), 300U);
  // A surface of one colour would take a kilobyte; grains do not compress.
  EXPECT_GT(png.size(), 20'000U);
}

TEST_F(SnapshotCommand, SoilThatIsNotInTimeMakesNoPictureWhereThatIsRequired) {
  if (!canDraw()) {
    GTEST_SKIP() << "no chromium, or instrumented code";
  }
  // Tens of thousands of particles in one millisecond: no machine holds that on one thread.
  const ProgramResult result =
      snapshot("view.png",
               "--require-in-time --at-s 0.02 --width 320 --height 240 --no-panels --set "
               "bed.width_mm=1200 --set bed.length_mm=1200 --set bed.start=packed --set bed.depth_mm=60 --set "
               "soil.friction_model=contact");
  if (result.errors.find("built without its page") != std::string::npos) {
    GTEST_SKIP() << "no page in this build";
  }
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, testing::AllOf(HasSubstr("ticks took longer than 1 ms"), HasSubstr("0.1 % are allowed")));
  EXPECT_EQ(files(), 0U);
}

TEST_F(SnapshotCommand, AnInterruptedFilmLeavesNothingBehind) {
  if (!canDraw("ffmpeg")) {
    GTEST_SKIP() << "no chromium or no ffmpeg, or instrumented code";
  }
  const ProgramResult result = runInShell(fmt::format(
      "TMPDIR='{}' \"$HAPTOLITH\" snapshot icra2021 --film --width 320 --height 240 --out '{}' & sleep 2; kill -INT "
      "$!; wait $!",
      temporary_.string(), (folder_ / "film.mp4").string()));
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, testing::AnyOf(HasSubstr("interrupted"), HasSubstr("built without its page")));
  EXPECT_EQ(files(), 0U);
}

}  // namespace
}  // namespace haptolith

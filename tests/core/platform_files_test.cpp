#include <gmock/gmock.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

#include "haptolith/core/platform/descriptor.h"
#include "haptolith/core/platform/files.h"
#include "haptolith/core/platform/locks.h"
#include "haptolith/core/platform/this_program.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;

class PlatformFiles : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);  // left by a test that was killed
    ASSERT_TRUE(createFolder(folder_, true));
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path write(const char* name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  static std::string read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  /// With letters that are no ASCII, and a space.
  fs::path folder_ = fs::path(testing::TempDir()) / fs::path(u8"plätze für dateien " + [] {
                       const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
                       return std::u8string(test.begin(), test.end());
                     }());
};

TEST_F(PlatformFiles, ANewFileIsWrittenFlushedAndNamed) {
  const Descriptor made(createNewFile(folder_ / "part", true));
  ASSERT_GE(made.number(), 0);
  const std::string bytes(1 << 20, '\n');  // no line ends are translated
  EXPECT_TRUE(writeBytes(made.number(), bytes));
  EXPECT_TRUE(flushToDisk(made.number()));
  EXPECT_EQ(fs::file_size(folder_ / "part"), bytes.size());
}

TEST_F(PlatformFiles, NoExistingFileIsOpenedAsANewOne) {
  const fs::path there = write("there", "kept");
  EXPECT_EQ(createNewFile(there, false), -1);
  EXPECT_EQ(errno, EEXIST);
  EXPECT_EQ(read(there), "kept");
  EXPECT_FALSE(createFolder(folder_, false));
  EXPECT_EQ(errno, EEXIST);
}

TEST_F(PlatformFiles, ARenamedFileReplacesOnlyIfItMay) {
  const fs::path made = write("made", "new");
  const fs::path there = write("there", "old");
  EXPECT_FALSE(renameFile(made, there, false));
  EXPECT_EQ(errno, EEXIST);
  EXPECT_EQ(read(there), "old");
  EXPECT_TRUE(renameFile(made, there, true));
  EXPECT_EQ(read(there), "new");
  EXPECT_FALSE(fs::exists(made));
  EXPECT_TRUE(renameFile(there, made, false));
  EXPECT_FALSE(renameFile(folder_ / "nothing", there, false));
  EXPECT_EQ(errno, ENOENT);
}

TEST_F(PlatformFiles, AFileIsTheSameByEveryName) {
  const fs::path one = write("one", "text");
  const fs::path other = write("other", "text");
  fs::create_hard_link(one, folder_ / "link");
  ASSERT_TRUE(identityOf(one));
  EXPECT_EQ(identityOf(one), identityOf(folder_ / "link"));
  EXPECT_EQ(identityOf(one), identityOf(folder_ / "." / "one"));
  EXPECT_NE(identityOf(one), identityOf(other));
  EXPECT_FALSE(identityOf(folder_ / "nothing"));
  EXPECT_TRUE(identityOf(folder_));
}

TEST_F(PlatformFiles, RandomNumbersDiffer) {
  std::array<std::byte, 16> one{};
  std::array<std::byte, 16> other{};
  ASSERT_TRUE(fillWithRandom(one));
  ASSERT_TRUE(fillWithRandom(other));
  EXPECT_NE(one, other);
}

TEST_F(PlatformFiles, AFolderIsHeldByOneAtATime) {
  {
    const FolderLock lock(folder_);
    EXPECT_TRUE(lock.held());
    EXPECT_FALSE(FolderLock(folder_).held());
  }
  EXPECT_TRUE(FolderLock(folder_).held());
  EXPECT_ANY_THROW(FolderLock(folder_ / "nothing"));
}

TEST_F(PlatformFiles, AnOpenFileIsReadAtAnyPlace) {
  const Descriptor file(openForReading(write("file", "0123456789")));
  std::array<char, 4> bytes{};
  EXPECT_EQ(sizeOf(file.number()), 10U);
  EXPECT_EQ(readAt(file.number(), 3, std::as_writable_bytes(std::span(bytes))), 4);
  EXPECT_EQ(std::string(bytes.data(), 4), "3456");
  EXPECT_EQ(readAt(file.number(), 8, std::as_writable_bytes(std::span(bytes))), 2) << "two are left";
  EXPECT_EQ(readAt(file.number(), 20, std::as_writable_bytes(std::span(bytes))), 0);
  EXPECT_EQ(openForReading(folder_ / "nothing"), -1);
  EXPECT_EQ(errno, ENOENT);
}

TEST_F(PlatformFiles, DiscardedWritesSucceedAndReachNothing) {
  const Descriptor file(createNewFile(folder_ / "file", false));
  EXPECT_TRUE(writeBytes(file.number(), "kept"));
  discardWrites(file.number());
  EXPECT_TRUE(writeBytes(file.number(), "lost"));
  EXPECT_EQ(read(folder_ / "file"), "kept");
}

TEST_F(PlatformFiles, AFileThatWasRemovedIsKnown) {
  const Descriptor file(openForReading(write("file", "text")));
  EXPECT_FALSE(wasRemoved(file.number()));
  if (kOpenFilesCanBeRenamed) {
    fs::remove(folder_ / "file");
    EXPECT_TRUE(wasRemoved(file.number()));
  }
}

TEST_F(PlatformFiles, AFileIsHeldByOneAtATimeWhoIsKnown) {
  const fs::path path = folder_ / "file-lock";
  {
    const FileLock lock(path);
    EXPECT_TRUE(lock.held());
    const FileLock other(path);
    EXPECT_FALSE(other.held());
    EXPECT_EQ(other.holder(), std::to_string(processNumber()));
  }
  EXPECT_TRUE(FileLock(path).held());
  EXPECT_ANY_THROW(FileLock(folder_ / "nothing" / "file-lock"));
}

TEST(ThisProgram, KnowsItsMachineAndOtherPrograms) {
  EXPECT_GT(processNumber(), 0);
  EXPECT_THAT(systemName(), testing::AnyOf(testing::StartsWith("Linux "), testing::StartsWith("Windows ")));
  EXPECT_FALSE(hostName().empty());
  EXPECT_THAT(programFile().filename().string(), testing::HasSubstr("test_core"));
  EXPECT_TRUE(isProgram(programFile()));
  EXPECT_FALSE(isProgram(programFile().parent_path() / "nothing"));
  EXPECT_TRUE(programInPath("no-program-has-this-name").empty());
  EXPECT_FALSE(programInPath(programFileName("sh") == "sh" ? "sh" : "cmd").empty());
  EXPECT_GE(raiseFileLimit(64), 64U);
}

TEST(ThisProgram, PassesOnItsArguments) {
#ifdef _WIN32
  GTEST_SKIP() << "they are those of this process, whatever it is asked: tests/packages/windows_program.sh";
#endif
  const std::array<const char*, 2> arguments{"haptolith", "größe=2"};
  EXPECT_THAT(programArguments(2, arguments.data()), testing::ElementsAre("haptolith", "größe=2"));
}

}  // namespace
}  // namespace haptolith

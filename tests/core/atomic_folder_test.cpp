#include "haptolith/core/files/atomic_folder.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <string>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class AtomicFolderTest : public testing::Test {
 protected:
  AtomicFolderTest() : folder_(fs::path(testing::TempDir()) / ("haptolith_atomic_folder_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~AtomicFolderTest() override { fs::remove_all(folder_); }

  [[nodiscard]] int entries() const {
    return static_cast<int>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  static std::string read(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  fs::path folder_;
};

TEST_F(AtomicFolderTest, AppearsWithAllItsFilesOnCommit) {
  const AtomicFolder made(folder_ / "out/");
  made.write("a.txt", "a");
  made.write("in/side/b.txt", "b");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  made.commit();
  EXPECT_EQ(read(folder_ / "out/a.txt"), "a");
  EXPECT_EQ(read(folder_ / "out/in/side/b.txt"), "b");
  EXPECT_EQ(entries(), 1);
}

TEST_F(AtomicFolderTest, LeavesNothingWithoutCommit) {
  { AtomicFolder(folder_ / "out").write("a.txt", "a"); }
  EXPECT_EQ(entries(), 0);
}

TEST_F(AtomicFolderTest, RefusesANameThatIsTaken) {
  fs::create_directory(folder_ / "out");
  std::ofstream(folder_ / "file") << "x";
  EXPECT_THROW(AtomicFolder(folder_ / "out"), Failure);
  EXPECT_THROW(AtomicFolder(folder_ / "file", IfThere::kReplace), Failure);
  EXPECT_THROW(AtomicFolder(folder_ / "no/such/folder"), Failure);
  EXPECT_EQ(entries(), 2);
}

TEST_F(AtomicFolderTest, ReplacesAFolderWholeWhenAskedTo) {
  fs::create_directory(folder_ / "out");
  std::ofstream(folder_ / "out/old.txt") << "old";
  const AtomicFolder made(folder_ / "out", IfThere::kReplace);
  made.write("new.txt", "new");
  EXPECT_TRUE(fs::exists(folder_ / "out/old.txt"));
  made.commit();
  EXPECT_FALSE(fs::exists(folder_ / "out/old.txt"));
  EXPECT_EQ(read(folder_ / "out/new.txt"), "new");
  EXPECT_EQ(entries(), 1);
}

TEST_F(AtomicFolderTest, NoNameLeadsOutOfIt) {
  const AtomicFolder made(folder_ / "out");
  for (const char* name : {"../a.txt", "/tmp/haptolith-escaped.txt", "in/../../a.txt", "", "in/./a.txt"}) {
    EXPECT_THROW(made.write(name, "a"), Failure) << name;
  }
  EXPECT_THROW(made.write(std::string("a\0b", 3), "a"), Failure);
  made.commit();
  EXPECT_TRUE(fs::is_empty(folder_ / "out"));
  EXPECT_EQ(entries(), 1);
}

TEST_F(AtomicFolderTest, IsForItsOwnerAloneWhenAskedTo) {
  const AtomicFolder made(folder_ / "out", IfThere::kRefuse, Readers::kOwner);
  made.write("in/a.txt", "a");
  made.commit();
  EXPECT_EQ(fs::status(folder_ / "out").permissions(), fs::perms::owner_all);
  EXPECT_EQ(fs::status(folder_ / "out/in/a.txt").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(AtomicFolderTest, TakesNoNameThatSomebodyElseHasTakenMeanwhile) {
  const AtomicFolder made(folder_ / "out");
  fs::create_directory(folder_ / "out");
  EXPECT_THROW(made.commit(), Failure);
}

TEST_F(AtomicFolderTest, ReportsAFullDisk) {
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit full{100, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &full);
  try {
    AtomicFolder(folder_ / "out").write("a.txt", std::string(1000, 'a'));
    ADD_FAILURE() << "no error";
  } catch (const Failure& error) {
    EXPECT_THAT(error.what(), HasSubstr("out/a.txt"));
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(entries(), 0);
}

}  // namespace
}  // namespace haptolith

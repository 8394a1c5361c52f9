#include "haptolith/core/files/atomic_file.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/files/input_file.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class AtomicFileTest : public testing::Test {
 protected:
  AtomicFileTest() : folder_(fs::path(testing::TempDir()) / ("haptolith_atomic_file_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~AtomicFileTest() override { fs::remove_all(folder_); }

  [[nodiscard]] int files() const {
    return static_cast<int>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  static std::string read(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  fs::path folder_;
};

template <class Action>
std::string failureOf(Action action) {
  try {
    action();
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "no failure";
}

TEST_F(AtomicFileTest, AppearsWholeOnCommit) {
  const fs::path path = folder_ / "data.csv";
  AtomicFile file(path);
  file.write("one\n");
  file.write("two\n");
  EXPECT_FALSE(fs::exists(path));
  file.commit();
  EXPECT_EQ(read(path), "one\ntwo\n");
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFileTest, ReplacesWhatALinkLeadsTo) {
  std::ofstream(folder_ / "real.csv") << "old";
  fs::create_symlink("real.csv", folder_ / "link.csv");
  AtomicFile file({folder_ / "link.csv", IfThere::kReplace});
  file.write("new");
  file.commit();
  EXPECT_EQ(read(folder_ / "real.csv"), "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.csv"));
}

TEST_F(AtomicFileTest, LeavesAWriteProtectedFileAlone) {
  const fs::path path = folder_ / "data.csv";
  std::ofstream(path) << "old";
  fs::permissions(path, fs::perms::owner_read);
  EXPECT_THAT(failureOf([&] { AtomicFile({path, IfThere::kReplace}); }), HasSubstr("is write-protected"));
}

TEST_F(AtomicFileTest, TakesNamesAsLongAsTheFileSystemDoes) {
  std::string name(251, 'x');
  AtomicFile(folder_ / (name + ".csv")).commit();
  EXPECT_TRUE(fs::exists(folder_ / (name + ".csv")));
  name = "x";
  while (name.size() < 250) {
    name += "\u571f";  // three bytes
  }
  AtomicFile(folder_ / (name + ".csv")).commit();
  EXPECT_TRUE(fs::exists(folder_ / (name + ".csv")));
}

TEST_F(AtomicFileTest, LeavesNothingWithoutCommit) {
  {
    AtomicFile file(folder_ / "data.csv");
    file.write("half of it");
  }
  EXPECT_EQ(files(), 0);
}

TEST_F(AtomicFileTest, KeepsTheOldFileUntilTheNewOneIsWhole) {
  const fs::path path = folder_ / "data.csv";
  std::ofstream(path) << "old";
  {
    AtomicFile file({path, IfThere::kReplace});
    file.write("new, never finished");
  }
  EXPECT_EQ(read(path), "old");
  AtomicFile file({path, IfThere::kReplace});
  file.write("new");
  file.commit();
  EXPECT_EQ(read(path), "new");
}

TEST_F(AtomicFileTest, ReplacesNothingUnlessItIsAskedTo) {
  const fs::path path = folder_ / "data.csv";
  std::ofstream(path) << "old";
  EXPECT_EQ(failureOf([&] { AtomicFile file(path); }),
            path.string() + " already exists: choose another name, or add --overwrite");
  fs::create_symlink("nowhere", folder_ / "link.csv");
  EXPECT_THAT(failureOf([&] { AtomicFile file(folder_ / "link.csv"); }), HasSubstr("already exists"));
  EXPECT_EQ(read(path), "old");
  EXPECT_EQ(files(), 2);
}

TEST_F(AtomicFileTest, ReplacesNothingThatHasComeMeanwhile) {
  const fs::path path = folder_ / "data.csv";
  const std::string message = failureOf([&] {
    AtomicFile file(path);
    file.write("new");
    std::ofstream(path) << "somebody else's";
    file.commit();
  });
  EXPECT_THAT(message, HasSubstr("data.csv was created by another program: saved as"));
  EXPECT_EQ(read(path), "somebody else's");
  EXPECT_EQ(read(folder_ / "data-2.csv"), "new");
  EXPECT_EQ(files(), 2);
}

TEST_F(AtomicFileTest, NeverReplacesARecordingOrAStudy) {
  std::ofstream(folder_ / "run.csv", std::ios::binary) << "\x89HDF\r\n\x1a\n and so on";
  std::ofstream(folder_ / "friction.csv") << "SQLite format 3" << '\0' << "and so on";
  EXPECT_THAT(failureOf([&] { AtomicFile file({folder_ / "run.csv", IfThere::kReplace}); }), HasSubstr("a recording"));
  EXPECT_THAT(failureOf([&] { AtomicFile file({folder_ / "friction.csv", IfThere::kReplace}); }), HasSubstr("a study"));
}

TEST_F(AtomicFileTest, NeverReplacesWhatThisProgramHasRead) {
  std::ofstream(folder_ / "poses.csv") << "t_s\n";
  (void)openInput(folder_ / "poses.csv", 1000);
  fs::create_hard_link(folder_ / "poses.csv", folder_ / "other name.csv");
  for (const char* name : {"poses.csv", "other name.csv"}) {
    EXPECT_THAT(failureOf([&] {
                  AtomicFile file({folder_ / name, IfThere::kReplace});
                }),
                HasSubstr("this command reads it"));
  }
}

TEST_F(AtomicFileTest, ItsTemporaryNameCannotBeGuessedAndIsItsOwn) {
  const AtomicFile one(folder_ / "data.csv"), other(folder_ / "data.csv");
  EXPECT_NE(one.temporaryPath(), other.temporaryPath());
  fs::create_symlink(folder_ / "target", folder_ / "link");
  EXPECT_LT(makeNewFile(folder_ / "link", Readers::kAsUsual), 0) << "no link is followed";
  EXPECT_FALSE(fs::exists(folder_ / "target"));
}

TEST_F(AtomicFileTest, IsForItsOwnerAloneWhenAskedTo) {
  const mode_t before = umask(022);
  for (const auto& [name, readers] : {std::pair{"usual.csv", Readers::kAsUsual}, {"owner.csv", Readers::kOwner}}) {
    AtomicFile file({folder_ / name, IfThere::kRefuse, readers});
    file.commit();
  }
  umask(before);
  constexpr fs::perms kOwner = fs::perms::owner_read | fs::perms::owner_write;
  EXPECT_EQ(fs::status(folder_ / "owner.csv").permissions(), kOwner);
  EXPECT_EQ(fs::status(folder_ / "usual.csv").permissions(), kOwner | fs::perms::group_read | fs::perms::others_read);
}

TEST_F(AtomicFileTest, KeepsTheExtensionLastSoThatOtherProgramsKnowTheFormat) {
  const AtomicFile file(folder_ / "figure.svg");
  EXPECT_EQ(file.temporaryPath().extension(), ".svg");
  EXPECT_EQ(file.temporaryPath().parent_path(), folder_);
}

// A file-size limit replaces a full disk: the write returns short, with an error.
class SizeLimit {
 public:
  explicit SizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit{bytes, old_limit_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }
  SizeLimit(const SizeLimit&) = delete;
  SizeLimit& operator=(const SizeLimit&) = delete;

 private:
  rlimit old_limit_{};
  void (*old_handler_)(int);
};

TEST_F(AtomicFileTest, AFullDiskIsAFailureAndLeavesTheOldFile) {
  const fs::path path = folder_ / "data.csv";
  std::ofstream(path) << "old";
  const std::string message = failureOf([&] {
    const SizeLimit limit(4096);
    AtomicFile file({path, IfThere::kReplace});
    file.write(std::string(1 << 20, 'x'));
    file.commit();
  });
  EXPECT_THAT(message, HasSubstr("cannot write " + path.string()));
  EXPECT_THAT(message, HasSubstr("File too large"));
  EXPECT_EQ(read(path), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFileTest, AFullDiskIsNoticedEvenWhenTheLastBytesWaitInTheBuffer) {
  const std::string message = failureOf([&] {
    const SizeLimit limit(16);
    AtomicFile file(folder_ / "data.csv");
    file.write("thirty bytes, still buffered..");
    file.commit();
  });
  EXPECT_THAT(message, HasSubstr("cannot write"));
  EXPECT_EQ(files(), 0);
}

TEST_F(AtomicFileTest, RefusesAFolderThatIsMissing) {
  const fs::path path = folder_ / "missing" / "data.csv";
  EXPECT_EQ(failureOf([&] { AtomicFile file(path); }),
            "cannot create " + path.string() + ": No such file or directory");
}

TEST_F(AtomicFileTest, RefusesToReplaceAFolder) {
  EXPECT_EQ(failureOf([&] { AtomicFile file(folder_); }), "cannot open " + folder_.string() + ": Is a directory");
  EXPECT_EQ(files(), 0);
}

TEST_F(AtomicFileTest, RefusesToReplaceADevice) {
  EXPECT_THAT(failureOf([] { AtomicFile file("/dev/full"); }), HasSubstr("not a regular file"));
}

}  // namespace
}  // namespace haptolith

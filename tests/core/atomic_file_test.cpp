#include "haptolith/core/atomic_file.h"

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
    AtomicFile file(path);
    file.write("new, never finished");
  }
  EXPECT_EQ(read(path), "old");
  AtomicFile file(path);
  file.write("new");
  file.commit();
  EXPECT_EQ(read(path), "new");
}

TEST_F(AtomicFileTest, KeepsTheExtensionLastSoThatOtherProgramsKnowTheFormat) {
  const AtomicFile file(folder_ / "figure.svg");
  EXPECT_EQ(file.temporaryPath().extension(), ".svg");
  EXPECT_EQ(file.temporaryPath().parent_path(), folder_);
}

// A file-size limit stands in for a full disk: the write comes back short, with an error.
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
    AtomicFile file(path);
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

#include "haptolith/core/files/input_file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/stop_asked.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr TextLimits kFew{.bytes = 100, .line_bytes = 10, .rows = 3};

class InputFileTest : public testing::Test {
 protected:
  InputFileTest() { fs::create_directories(folder_); }
  ~InputFileTest() override { fs::remove_all(folder_); }

  static std::string refusalOf(const fs::path& path, std::uintmax_t most_bytes = 1000) {
    try {
      (void)openInput(path, most_bytes);
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "no refusal";
  }

  const fs::path folder_ = fs::temp_directory_path() / ("haptolith-input-file-test-" + std::to_string(getpid()));
};

TEST_F(InputFileTest, IsReadLineByLine) {
  std::ofstream(folder_ / "a.csv") << "one\n\nthree";
  std::ifstream file = openInput(folder_ / "a.csv", 100);
  LineReader lines(file, "a.csv", kFew);
  std::vector<std::string> read;
  for (std::string line; lines.next(line);) {
    read.push_back(std::to_string(lines.number()) + line);
  }
  EXPECT_THAT(read, testing::ElementsAre("1one", "2", "3three"));
}

TEST_F(InputFileTest, IsARegularFile) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(refusalOf(folder_ / "pipe"), HasSubstr("a pipe")) << "and opening it did not wait for a writer";
  fs::create_symlink("/dev/zero", folder_ / "zero");
  EXPECT_THAT(refusalOf(folder_ / "zero"), HasSubstr("a device"));
  EXPECT_THAT(refusalOf(folder_), HasSubstr("a folder"));
  EXPECT_EQ(refusalOf("none.csv"), "file = 'none.csv' is not valid: must be a file; there is no such file");
}

TEST_F(InputFileTest, IsNoLargerThanItMayBe) {
  std::ofstream(folder_ / "large.csv") << std::string(1001, 'x');
  EXPECT_THAT(refusalOf(folder_ / "large.csv"), AllOf(HasSubstr("large.csv"), HasSubstr("at most 1000 bytes")));
}

TEST(LineReader, TakesLineEndsOfEverySystem) {
  std::istringstream text("one\r\ntwo\rthree\n\r\rfour");
  LineReader lines(text, "a.csv", kFew);
  std::vector<std::string> read;
  for (std::string line; lines.next(line);) {
    read.push_back(std::to_string(lines.number()) + line);
    EXPECT_EQ(lines.ended(), line != "four");
  }
  EXPECT_THAT(read, testing::ElementsAre("1one", "2two", "3three", "4", "5", "6four"));
}

TEST(LineReader, EndsAtALineThatIsTooLongAndQuotesItsBeginning) {
  std::istringstream text("short\n\033]0;pwned you\a");
  LineReader lines(text, "a.csv", kFew);
  std::string line;
  ASSERT_TRUE(lines.next(line));
  try {
    (void)lines.next(line);
    FAIL();
  } catch (const InvalidParameter& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("a.csv:2: line"), HasSubstr("\\u001b]0;"), HasSubstr("at most 10 bytes")));
  }
}

TEST(LineReader, EndsWhereATextGoesOnWithoutEnd) {
  std::istringstream text(std::string(101, '\n'));
  LineReader lines(text, "a.csv", kFew);
  std::string line;
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(lines.next(line));
  }
  EXPECT_THROW((void)lines.next(line), InvalidParameter);
}

TEST(LineReader, EndsWhenSomebodyWantsTheWorkToEnd) {
  std::istringstream text("one\ntwo\n");
  LineReader lines(text, "a.csv", kFew);
  std::string line;
  ASSERT_TRUE(lines.next(line));
  stopAsked() = true;
  EXPECT_THROW((void)lines.next(line), Failure);
  stopAsked() = false;
}

}  // namespace
}  // namespace haptolith

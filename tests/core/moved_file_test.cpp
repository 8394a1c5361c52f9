#include "haptolith/core/files/moved_file.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <vector>

#include "haptolith/core/files/input_file.h"
#include "haptolith/core/former_names.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class MovedFileTest : public testing::Test {
 protected:
  MovedFileTest() {
    fs::create_directories(folder_ / "scenes");
    std::ofstream(folder_ / "scenes" / "sand.csv") << "1\n";
    std::ofstream(folder_ / "scenes" / "plate-recorded.csv") << "2\n";
    onFormerName([this](std::string_view line) { reported_.emplace_back(line); });
  }
  ~MovedFileTest() override {
    onFormerName({});
    fs::remove_all(folder_);
  }

  const fs::path folder_ = fs::temp_directory_path() / ("haptolith-moved-file-test-" + std::to_string(getpid()));
  const fs::path old_ = folder_ / "scenarios" / "sand.csv";
  std::vector<std::string> reported_;
};

TEST_F(MovedFileTest, IsFoundWhereItIsNowWithOneNote) {
  EXPECT_EQ(currentPath(old_), folder_ / "scenes" / "sand.csv");
  EXPECT_TRUE(openInput(old_, 10).good());
  EXPECT_THAT(reported_, ElementsAre(HasSubstr("scenarios/sand.csv is now ")));
}

TEST_F(MovedFileTest, IsFoundUnderItsNewName) {
  for (const char* folder : {"scenarios", "scenes"}) {
    EXPECT_EQ(currentPath(folder_ / folder / "plate-in-sand.csv"), folder_ / "scenes" / "plate-recorded.csv");
  }
}

TEST_F(MovedFileTest, OtherPathsStayAsTheyAre) {
  for (const fs::path& path : {folder_ / "scenes" / "sand.csv", folder_ / "scenarios" / "none.csv", fs::path("sand")}) {
    EXPECT_EQ(currentPath(path), path);
  }
  fs::create_directory(folder_ / "scenarios");
  std::ofstream(folder_ / "scenarios" / "sand.csv") << "my own\n";
  EXPECT_EQ(currentPath(old_), old_);
  EXPECT_THAT(reported_, ElementsAre());
}

}  // namespace
}  // namespace haptolith

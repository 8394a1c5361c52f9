#include "haptolith/session/trip_files.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Runs with a separate home, and started in another folder, where no file may be left.
class TripFilesTest : public testing::Test {
 protected:
  TripFilesTest()
      : before_(fs::current_path()), folder_(fs::path(testing::TempDir()) / fmt::format("trips_{}", getpid())) {
    fs::create_directories(here());
    fs::current_path(here());
    const char* home = std::getenv("HOME");
    home_ = home == nullptr ? "" : home;
    setenv("HOME", folder_.c_str(), 1);
    unsetenv("XDG_STATE_HOME");
  }
  ~TripFilesTest() override {
    setenv("HOME", home_.c_str(), 1);
    fs::current_path(before_);
    fs::remove_all(folder_);
  }

  [[nodiscard]] const TripReport& at(double time_s) {
    report_->trip = SafetyTrip::kStale;
    report_->time_s = time_s;
    report_->count = 2;
    return *report_;
  }
  [[nodiscard]] fs::path here() const { return folder_ / "here"; }
  [[nodiscard]] static std::ptrdiff_t filesIn(const fs::path& folder) {
    return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
  }
  [[nodiscard]] fs::path kept() const { return folder_ / ".local/state/haptolith"; }
  [[nodiscard]] std::ptrdiff_t files() const { return filesIn(kept()); }

  std::unique_ptr<TripReport> report_ = std::make_unique<TripReport>();
  fs::path before_, folder_;
  std::string home_;
};

TEST_F(TripFilesTest, SayWhyAndKeepTheTicksBefore) {
  TripFiles trips;
  EXPECT_THAT(trips.tell(at(1.25), "", "no answer from the handle"),
              AllOf(HasSubstr("safety trip at 1.250 s"), HasSubstr(text(SafetyTrip::kStale)),
                    HasSubstr("no answer from the handle"),
                    HasSubstr("the last 2 ticks are in " + (kept() / "haptolith-trip-").string())));
  ASSERT_EQ(files(), 1);
  EXPECT_EQ(filesIn(here()), 0);
  std::ifstream file(fs::directory_iterator(kept())->path());
  int lines = 0;
  for (std::string line; std::getline(file, line);) {
    ++lines;
  }
  EXPECT_EQ(lines, 2 + 2) << "reason, names of the columns, two ticks";
  EXPECT_THAT(trips.rest(), IsEmpty());
}

TEST_F(TripFilesTest, NameTheToolOfSeveral) {
  TripFiles trips;
  EXPECT_THAT(trips.tell(at(1), "left", ""), HasSubstr("safety trip at 1.000 s: left: "));
  std::ifstream file(fs::directory_iterator(kept())->path());
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, fmt::format("# at 1.000 s: left: {}", text(SafetyTrip::kStale)));
}

TEST_F(TripFilesTest, StandWhereTheEnvironmentWantsThemAndHereWithoutAHome) {
  TripFiles trips;
  setenv("XDG_STATE_HOME", (folder_ / "states").c_str(), 1);
  (void)trips.tell(at(1), "", "");
  EXPECT_EQ(filesIn(folder_ / "states/haptolith"), 1);
  unsetenv("XDG_STATE_HOME");
  unsetenv("HOME");
  EXPECT_THAT(trips.tell(at(2), "", ""), HasSubstr("ticks are in haptolith-trip-"));
  EXPECT_EQ(filesIn(here()), 1);
}

TEST_F(TripFilesTest, EndAfterTwentyAndThenItIsToldOnceASecond) {
  TripFiles trips;
  for (int i = 0; i < 20; ++i) {
    EXPECT_THAT(trips.tell(at(0.01 * i), "", ""), HasSubstr("the last 2 ticks are in")) << i;
  }
  EXPECT_EQ(files(), 20);
  for (int i = 0; i < 50; ++i) {
    EXPECT_THAT(trips.tell(at(0.2 + 0.01 * i), "", ""), IsEmpty()) << i;
  }
  EXPECT_THAT(trips.tell(at(2), "", ""), AllOf(HasSubstr("50 more times before"), Not(HasSubstr("ticks are in"))));
  EXPECT_THAT(trips.tell(at(2.1), "", ""), IsEmpty());
  EXPECT_THAT(trips.rest(), HasSubstr("1 more time"));
  EXPECT_EQ(files(), 20);
}

}  // namespace
}  // namespace haptolith

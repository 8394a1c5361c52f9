#include "haptolith/session/trip_files.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

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

/// In a folder of its own, for the files are written where the program was started.
class TripFilesTest : public testing::Test {
 protected:
  TripFilesTest()
      : before_(fs::current_path()), folder_(fs::path(testing::TempDir()) / fmt::format("trips_{}", getpid())) {
    fs::create_directories(folder_);
    fs::current_path(folder_);
  }
  ~TripFilesTest() override {
    fs::current_path(before_);
    fs::remove_all(folder_);
  }

  [[nodiscard]] const TripReport& at(double time_s) {
    report_->trip = SafetyTrip::kStale;
    report_->time_s = time_s;
    report_->count = 2;
    return *report_;
  }
  [[nodiscard]] std::ptrdiff_t files() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  std::unique_ptr<TripReport> report_ = std::make_unique<TripReport>();
  fs::path before_, folder_;
};

TEST_F(TripFilesTest, SayWhyAndKeepTheTicksBefore) {
  TripFiles trips;
  EXPECT_THAT(trips.tell(at(1.25), "no answer from the handle"),
              AllOf(HasSubstr("at 1.250 s the hand was let go"), HasSubstr(text(SafetyTrip::kStale)),
                    HasSubstr("no answer from the handle"), HasSubstr("the last 2 ticks are in haptolith-trip-")));
  ASSERT_EQ(files(), 1);
  std::ifstream file(fs::directory_iterator(folder_)->path());
  int lines = 0;
  for (std::string line; std::getline(file, line);) {
    ++lines;
  }
  EXPECT_EQ(lines, 2 + 2) << "reason, names of the columns, two ticks";
  EXPECT_THAT(trips.rest(), IsEmpty());
}

TEST_F(TripFilesTest, EndAfterTwentyAndThenItIsToldOnceASecond) {
  TripFiles trips;
  for (int i = 0; i < 20; ++i) {
    EXPECT_THAT(trips.tell(at(0.01 * i), ""), HasSubstr("the last 2 ticks are in")) << i;
  }
  EXPECT_EQ(files(), 20);
  for (int i = 0; i < 50; ++i) {
    EXPECT_THAT(trips.tell(at(0.2 + 0.01 * i), ""), IsEmpty()) << i;
  }
  EXPECT_THAT(trips.tell(at(2), ""), AllOf(HasSubstr("50 more times before"), Not(HasSubstr("ticks are in"))));
  EXPECT_THAT(trips.tell(at(2.1), ""), IsEmpty());
  EXPECT_THAT(trips.rest(), HasSubstr("1 more times"));
  EXPECT_EQ(files(), 20);
}

}  // namespace
}  // namespace haptolith

#include "haptolith/machine/machine_fit.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

FinestGrain someFit() {
  return {.chosen = {.radius_m = 4.4e-3, .grains = 1170, .substeps = 6, .threads = 1, .tick_us_p99 = 443.25},
          .too_slow = GrainTrial{.radius_m = 4e-3, .grains = 1560, .substeps = 6, .threads = 1, .tick_us_p99 = 712.5}};
}

TEST(MachineFit, IsSaidInALine) {
  EXPECT_EQ(text(someFit(), 1170),
            "4.4 mm particles on 1 thread: the finest soil that this machine renders in real time (1170 particles; 4 "
            "mm would "
            "need 0.71 ms per tick)");
  FinestGrain slow = someFit();
  slow.chosen.tick_us_p99 = 900;
  EXPECT_THAT(text(slow, 300), HasSubstr("ticks can be late on this machine"));
  FinestGrain beyond = someFit();
  beyond.too_slow->tick_us_p99 = std::numeric_limits<double>::infinity();
  EXPECT_THAT(text(beyond, 1170), HasSubstr("4 mm exceeds any machine"));
  beyond.too_slow.reset();
  EXPECT_THAT(text(beyond, 1170), HasSubstr("(1170 particles)"));
}

TEST(MachineFit, IsReadBackAsItWasKept) {
  for (const bool has_slower : {true, false}) {
    FinestGrain fit = someFit();
    if (!has_slower) {
      fit.too_slow.reset();
    }
    const std::optional<FinestGrain> read = finestIn(keptText(fit, "a key"), "a key");
    ASSERT_TRUE(read);
    EXPECT_EQ(text(*read, 1), text(fit, 1));
    EXPECT_EQ(read->chosen.tick_us_p99, fit.chosen.tick_us_p99);
    EXPECT_EQ(read->chosen.radius_m, fit.chosen.radius_m);
  }
}

TEST(MachineFit, IsNotReadFromADamagedTextOrOneOfAnotherKey) {
  const std::string kept = keptText(someFit(), "a key");
  EXPECT_FALSE(finestIn(kept, "another key"));
  for (std::size_t at = 0; at < kept.size(); ++at) {
    std::string damaged = kept;
    damaged[at] = damaged[at] == '7' ? '8' : '7';
    EXPECT_FALSE(finestIn(damaged, "a key") && at + 1 < kept.size()) << at;
    EXPECT_FALSE(finestIn(kept.substr(0, at), "a key") && at + 1 < kept.size()) << at;
  }
  EXPECT_FALSE(finestIn("", "a key"));
}

class MachineFitHere : public testing::Test {
 protected:
  MachineFitHere() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_fit_{}", getpid())) {
    fs::remove_all(folder_);
  }
  ~MachineFitHere() override { fs::remove_all(folder_); }

  FinestGrain fit(bool again = false) {
    scene_file_ = findSceneFile(kAutoScene);
    return fitToMachine(scene_file_,
                        {.threads = 1, .folder = folder_, .measure_again = again, .measuring = [this] { ++measured_; }},
                        stop_);
  }

  fs::path folder_;
  SceneFile scene_file_;
  std::atomic<bool> stop_{false};
  int measured_ = 0;
};

TEST_F(MachineFitHere, IsMeasuredOnceAndAgainWhereTheFileIsBroken) {
  const FinestGrain first = fit();
  EXPECT_EQ(measured_, 1);
  EXPECT_DOUBLE_EQ(scene_file_.bed.soil.radius_m, first.chosen.radius_m);
  EXPECT_EQ(scene_file_.bed.threads, 1);
  EXPECT_EQ(text(fit(), 1), text(first, 1));
  EXPECT_EQ(measured_, 1);
  (void)fit(true);
  EXPECT_EQ(measured_, 2);
  int files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    std::ofstream(entry.path()) << "haptolith machine";
    ++files;
  }
  EXPECT_EQ(files, 1);
  (void)fit();
  EXPECT_EQ(measured_, 3);
  (void)fit();
  EXPECT_EQ(measured_, 3) << "the broken file has been replaced";
}

TEST_F(MachineFitHere, ChangesTheRadiusInATitleThatNamesIt) {
  scene_file_ = findSceneFile(kAutoScene);
  scene_file_.bed.soil = rescaled(scene_file_.bed.soil, 9.9e-3);
  scene_file_.title = sceneInWords(scene_file_);
  const FinestGrain finest = fitToMachine(scene_file_, {.threads = 1, .folder = folder_, .measuring = {}}, stop_);
  EXPECT_NE(finest.chosen.radius_m, 9.9e-3);
  EXPECT_EQ(scene_file_.title, sceneInWords(scene_file_));
  scene_file_.title = "my soil";
  (void)fitToMachine(scene_file_, {.threads = 1, .folder = folder_, .measuring = {}}, stop_);
  EXPECT_EQ(scene_file_.title, "my soil");
}

TEST_F(MachineFitHere, ThatIsInterruptedIsNotKept) {
  stop_ = true;
  EXPECT_THROW((void)fit(), Failure);
  std::error_code ignored;
  EXPECT_TRUE(!fs::exists(folder_) || fs::is_empty(folder_, ignored));
}

TEST_F(MachineFitHere, RefusesASceneWhoseParticlesAreItsOwn) {
  SceneFile icra2021 = findSceneFile("icra2021");
  EXPECT_FALSE(canBeFitted(icra2021));
  EXPECT_THROW((void)fitToMachine(icra2021, {}, stop_), InvalidParameter);
  EXPECT_TRUE(canBeFitted(findSceneFile(kAutoScene)));
}

TEST(MachineFit, KnowsWhichKeysAreGiven) {
  const std::vector<std::string> given{"soil.radius_mm = 3", "bed.threads=2"};
  EXPECT_TRUE(setsKey(given, "soil.radius_mm"));
  EXPECT_TRUE(setsKey(given, "bed.threads"));
  EXPECT_FALSE(setsKey(given, "soil.radius"));
  EXPECT_FALSE(setsKey(given, "bed.depth_mm"));
}

TEST(MachineFit, LeavesACoreToOthers) {
  EXPECT_GE(loopThreads(), 1);
  EXPECT_LE(loopThreads(), 8);
}

}  // namespace
}  // namespace haptolith

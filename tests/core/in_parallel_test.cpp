#include "haptolith/core/in_parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

TEST(InParallel, DoesEveryPieceOnce) {
  for (const int threads : {1, 2, 7}) {
    std::vector<int> done(20);
    inParallel(done.size(), threads, [&](std::size_t i) { ++done[i]; });
    EXPECT_EQ(done, std::vector<int>(20, 1));
  }
  inParallel(0, 3, [](std::size_t) { FAIL(); });
}

TEST(InParallel, PassesAFailureOnAndStartsNothingNew) {
  std::atomic<int> started = 0;
  EXPECT_THROW(inParallel(1000, 2,
                          [&](std::size_t) {
                            ++started;
                            throw Failure("no");
                          }),
               Failure);
  EXPECT_LE(started, 2);
}

TEST(SharedProgress, TellsHowFarAllPiecesAreAndNeverGoesBack) {
  std::vector<double> told;
  LabConditions conditions;
  conditions.threads = 4;
  conditions.progress = [&](std::string_view, double share) {
    told.push_back(share);
    return true;
  };
  SharedProgress shared(conditions, 2);
  const LabConditions first = shared.conditionsOf(0);
  const LabConditions second = shared.conditionsOf(1);
  EXPECT_EQ(first.threads, 1);
  (void)first.progress("a", 0.5);
  (void)second.progress("b", 1);
  (void)first.progress("next phase", 0);
  EXPECT_EQ(told, (std::vector<double>{0.25, 0.75, 0.75}));
}

}  // namespace
}  // namespace haptolith

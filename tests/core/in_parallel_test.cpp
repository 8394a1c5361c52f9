#include "haptolith/core/process/in_parallel.h"

#include <gtest/gtest.h>

#include <atomic>
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

}  // namespace
}  // namespace haptolith

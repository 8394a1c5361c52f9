#include "haptolith/lab/shared_progress.h"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace haptolith {
namespace {

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

#include "haptolith/core/pluralise.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace haptolith {
namespace {

TEST(Counted, IsSingularForOneAlone) {
  EXPECT_EQ(pluralise(1, "trial"), "1 trial");
  EXPECT_EQ(pluralise(0, "trial"), "0 trials");
  EXPECT_EQ(pluralise(std::uint64_t{12}, "trial"), "12 trials");
  EXPECT_EQ(pluralise(1, "person", "people"), "1 person");
  EXPECT_EQ(pluralise(2, "person", "people"), "2 people");
}

}  // namespace
}  // namespace haptolith

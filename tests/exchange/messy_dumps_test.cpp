// Dumps as LAMMPS and people write them: each reads as a clean one, or is refused with a reason.

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/exchange/lammps_dump.h"

#include "../expectations.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

TEST(MessyDumps, ReadAsTheCleanOnesOrAreRefused) {
  const std::vector<Expectation> all = expectationsOf("particles");
  EXPECT_GE(all.size(), 30U);
  for (const Expectation& expected : all) {
    SCOPED_TRACE(expected.file.filename().string());
    std::string refusal = "accepted";
    LammpsPicture picture;
    try {
      picture = readLammpsDump(expected.file);
    } catch (const InvalidParameter& error) {
      refusal = error.what();
    }
    if (expected.clean.empty()) {
      EXPECT_THAT(refusal, HasSubstr(expected.words));
      continue;
    }
    ASSERT_EQ(refusal, "accepted");
    const LammpsPicture clean = readLammpsDump(expected.clean);
    ASSERT_EQ(picture.grains.size(), clean.grains.size());
    for (std::size_t i = 0; i < clean.grains.size(); ++i) {
      EXPECT_EQ(picture.grains[i].id, clean.grains[i].id);
      EXPECT_EQ(picture.grains[i].type, clean.grains[i].type);
      EXPECT_NEAR(picture.grains[i].radius_m, clean.grains[i].radius_m, 1e-12);
      EXPECT_LT((picture.grains[i].centre_m - clean.grains[i].centre_m).norm(), 1e-9) << i;
    }
  }
}

}  // namespace
}  // namespace haptolith

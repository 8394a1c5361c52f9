// Dumps as LAMMPS and people write them: each reads as a clean one, or is refused with a reason.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "haptolith/lammps/lammps_dump.h"

#include "../shared/messy_inputs.h"
#include "../source_dir.h"

namespace haptolith {
namespace {

void expectTheSame(const LammpsPicture& picture, const LammpsPicture& clean) {
  ASSERT_EQ(picture.grains.size(), clean.grains.size());
  for (std::size_t i = 0; i < clean.grains.size(); ++i) {
    EXPECT_EQ(picture.grains[i].id, clean.grains[i].id);
    EXPECT_EQ(picture.grains[i].type, clean.grains[i].type);
    EXPECT_NEAR(picture.grains[i].radius_m, clean.grains[i].radius_m, 1e-12);
    EXPECT_LT((picture.grains[i].centre_m - clean.grains[i].centre_m).norm(), 1e-9) << i;
  }
}

TEST(MessyDumps, ReadAsTheCleanOnesOrAreRefused) {
  const std::filesystem::path folder = sourceDir() / "tests/data/messy/particles";
  const std::vector<Expectation> all = expectationsIn(folder);
  EXPECT_GE(all.size(), 30U);
  for (const Expectation& expected : all) {
    expectAsWritten(expected, [&] {
      const LammpsPicture picture = readLammpsDump(folder / expected.input);
      if (!expected.clean.empty()) {
        expectTheSame(picture, readLammpsDump(folder / expected.clean));
      }
      return std::string();
    });
  }
}

}  // namespace
}  // namespace haptolith

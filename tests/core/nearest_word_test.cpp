#include "haptolith/core/nearest_word.h"

#include <gmock/gmock.h>

#include <array>

namespace haptolith {
namespace {

constexpr std::array<std::string_view, 4> kWords{"soil", "gravity", "rho0_kg_m3", "rho_max_kg_m3"};

TEST(NearestWord, ForgivesTypingErrors) {
  EXPECT_EQ(nearestWord("sol", kWords), "soil");
  EXPECT_EQ(nearestWord("gravitiy", kWords), "gravity");
  EXPECT_EQ(nearestWord("rho_0_kg_m3", kWords), "rho0_kg_m3");
}

TEST(NearestWord, KnowsAWordWithoutItsUnit) {
  EXPECT_EQ(nearestWord("rho_max", kWords), "rho_max_kg_m3");
}

TEST(NearestWord, DoesNotGuessWildly) {
  EXPECT_EQ(nearestWord("hand", kWords), "");
  EXPECT_EQ(nearestWord("", kWords), "");
  EXPECT_EQ(nearestWord("x", {}), "");
}

}  // namespace
}  // namespace haptolith

#include "haptolith/soil/bodies.h"

#include <gmock/gmock.h>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

TEST(Bodies, AreTheSixOfThePaperInOrderOfGravity) {
  ASSERT_EQ(bodies().size(), 6u);
  for (std::size_t i = 1; i < bodies().size(); ++i) {
    EXPECT_LT(bodies()[i - 1].gravity_m_s2, bodies()[i].gravity_m_s2);
  }
  EXPECT_DOUBLE_EQ(findBody("Ceres").gravity_m_s2, 0.270);
  EXPECT_DOUBLE_EQ(findBody("Pluto").gravity_m_s2, 0.625);
  EXPECT_DOUBLE_EQ(findBody("Europa").gravity_m_s2, 1.314);
  EXPECT_DOUBLE_EQ(findBody("Moon").gravity_m_s2, 1.625);
  EXPECT_DOUBLE_EQ(findBody("Mars").gravity_m_s2, 3.721);
  EXPECT_DOUBLE_EQ(findBody("Earth").gravity_m_s2, 9.807);
}

TEST(Bodies, AreFoundInUpperAndLowerCase) {
  EXPECT_EQ(findBody("moon").name, "Moon");
  EXPECT_EQ(findBody("EARTH").name, "Earth");
}

TEST(Bodies, AnUnknownNameIsRefusedWithTheValidOnes) {
  for (const char* name : {"Moo", "Moons", "", "Vulcan"}) {
    try {
      static_cast<void>(findBody(name));
      FAIL() << name;
    } catch (const InvalidParameter& error) {
      EXPECT_EQ(error.key(), "body");
      EXPECT_THAT(error.what(), testing::HasSubstr("Ceres, Pluto, Europa, Moon, Mars, Earth"));
    }
  }
}

}  // namespace
}  // namespace haptolith

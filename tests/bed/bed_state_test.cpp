#include "haptolith/bed/bed_state.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <string>

#include "haptolith/bed/bed.h"
#include "haptolith/core/error.h"

namespace haptolith {
namespace {

BedState someState() {
  Bed bed{BedParameters{}};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(bed.step(1e-3), StepStatus::kOk);
  }
  BedState state = bed.state();
  state.velocity[7] = {0.1F, -0.2F, 0.3F, 0};
  return state;
}

bool same(const std::vector<Float4>& a, const std::vector<Float4>& b) {
  return std::ranges::equal(
      a, b, [](const Float4& p, const Float4& q) { return p.x == q.x && p.y == q.y && p.z == q.z && p.w == q.w; });
}

TEST(BedState, ComesBackAsItWasSaved) {
  const BedState saved = someState();
  const BedState back = deserialiseBedState(serialise(saved));
  EXPECT_EQ(back.step, saved.step);
  EXPECT_TRUE(same(back.position, saved.position));
  EXPECT_TRUE(same(back.velocity, saved.velocity));
  EXPECT_TRUE(same(back.reference_position, saved.reference_position));
  EXPECT_EQ(back.particles(), saved.particles());
  EXPECT_EQ(stateHash(back), stateHash(saved));
}

TEST(BedState, HashSeesEveryPartOfTheState) {
  const BedState state = someState();
  const std::uint64_t hash = stateHash(state);
  BedState other = state;
  other.position[3].y = std::nextafter(other.position[3].y, 1.0F);
  EXPECT_NE(stateHash(other), hash);
  other = state;
  other.velocity[255].z = 1e-30F;
  EXPECT_NE(stateHash(other), hash);
  other = state;
  ++other.step;
  EXPECT_NE(stateHash(other), hash);
}

TEST(BedState, HashSeesWhatEachToolRemembers) {
  const BedState state = someState();
  std::vector<std::int8_t> side(state.particles());
  std::vector<Float4> slip(state.particles());
  const auto hashOf = [&] { return stateHash(state, std::vector<ToolTrace>{{}, {side, slip}}); };
  const std::uint64_t hash = hashOf();
  side[5] = -1;
  EXPECT_NE(hashOf(), hash);
  side[5] = 0;
  slip[17].y = 1e-9F;
  EXPECT_NE(hashOf(), hash);
}

TEST(BedState, BytesThatAreNoStateAreRefused) {
  EXPECT_THROW((void)deserialiseBedState(""), Failure);
  EXPECT_THROW((void)deserialiseBedState("not a bed"), Failure);
  EXPECT_THROW((void)deserialiseBedState(std::string(100'000, 'x')), Failure);
  EXPECT_THROW((void)deserialiseBedState(std::string(100'000, '\0')), Failure);
}

TEST(BedState, BytesCutShortAtAnyPlaceOrTooLongAreRefused) {
  const std::string whole = serialise(someState());
  for (std::size_t length = 0; length < whole.size(); length += 41) {
    EXPECT_THROW((void)deserialiseBedState(std::string_view(whole).substr(0, length)), Failure) << length;
  }
  EXPECT_THROW((void)deserialiseBedState(std::string_view(whole).substr(0, whole.size() - 1)), Failure);
  EXPECT_THROW((void)deserialiseBedState(whole + "x"), Failure);
}

TEST(BedState, AnotherVersionIsRefusedAndSaysSo) {
  std::string bytes = serialise(someState());
  bytes[7] = '9';
  try {
    (void)deserialiseBedState(bytes);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_THAT(failure.what(), testing::HasSubstr("another version"));
  }
}

TEST(BedState, AnAbsurdNumberOfParticlesIsRefusedBeforeMemoryIsAskedFor) {
  std::string bytes = serialise(someState());
  for (const std::uint64_t particles : {std::uint64_t{257}, std::uint64_t{255}, std::uint64_t{0}, ~std::uint64_t{0},
                                        std::uint64_t{1} << 60, (~std::uint64_t{0}) / 51}) {
    bytes.replace(16, 8, reinterpret_cast<const char*>(&particles), 8);
    EXPECT_THROW((void)deserialiseBedState(bytes), Failure) << particles;
  }
}

TEST(BedState, ABedGoesOnOnlyFromAStateThatIsOne) {
  Bed bed{BedParameters{}};
  const BedState good = bed.state();

  BedState state = good;
  state.particle_count = 200;
  state.position.resize(201);
  state.velocity.resize(201);
  state.reference_position.resize(201);
  EXPECT_THROW(bed.restore(state), InvalidParameter) << "another number of particles";

  state = good;
  state.position.resize(100);
  EXPECT_THROW(bed.restore(state), InvalidParameter) << "arrays of different length";

  for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    state = good;
    state.reference_position[9].x = value;  // would become the number of a cell
    EXPECT_THROW(bed.restore(state), InvalidParameter);
    state = good;
    state.position[9].z = value;
    EXPECT_THROW(bed.restore(state), InvalidParameter);
    state = good;
    state.velocity[9].y = value;
    EXPECT_THROW(bed.restore(state), InvalidParameter);
  }

  state = good;
  std::ranges::fill(state.reference_position, Float4{});  // all in one point: no list holds that
  EXPECT_THROW(bed.restore(state), InvalidParameter);

  // A refused state leaves the bed as it was.
  EXPECT_EQ(stateHash(bed.state()), stateHash(good));
  EXPECT_EQ(bed.step(1e-3), StepStatus::kOk);
}

}  // namespace
}  // namespace haptolith

#include "haptolith/bed/start/bed_tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

/// Shallow, so that its tile settles in a second.
BedParameters settledBed(FrictionModel friction = FrictionModel::kContact) {
  BedParameters bed;
  bed.soil = findPreset("P3").soil;
  bed.soil.friction = friction;
  bed.soil.size_spread = 0.1;
  bed.soil.contact_cohesion_n = 2e-3;
  bed.start = BedStart::kSettled;
  bed.width_m = 0.6;
  bed.length_m = 0.45;
  bed.depth_m = 0.035;
  bed.sleep_speed_m_s = 1e-3;
  return bed;
}

double stepOf(const BedParameters& bed) {
  return bed.tick_s / substepsFor(bed.soil, 0, bed.tick_s, bed.max_substeps);
}

TEST(SettledStart, FillsTheBoxUpToItsDepthAsDenselyAsRainDoes) {
  const BedParameters parameters = settledBed();
  const Bed bed(parameters);
  const double grain_m3 = 4 * M_PI / 3 * std::pow(parameters.soil.radius_m, 3);
  const std::size_t free = bed.particles() - bed.heldParticles();
  const double solid =
      static_cast<double>(free) * grain_m3 / (parameters.width_m * parameters.length_m * parameters.depth_m);
  EXPECT_GT(solid, 0.50);  // surface and walls are looser than the 0.64 of a random packing
  EXPECT_LT(solid, 0.66);
  EXPECT_NEAR(bed.surfaceHeight(), parameters.depth_m, 0.3 * parameters.soil.radius_m);
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Float4& p = bed.state().position[i];
    const double radius_m = parameters.soil.radius_m + p.w;
    const double in_sides_m = radius_m + std::max(std::abs(p.x) - parameters.width_m / 2,  //
                                                  std::abs(p.y) - parameters.length_m / 2);
    EXPECT_EQ(in_sides_m > 1e-7, i >= free) << "held where it stands in the sides, " << in_sides_m;
    EXPECT_LE(in_sides_m, heldWidth(parameters) + 1e-7);
    EXPECT_GT(p.z, 0.5 * parameters.soil.radius_m);
  }
}

TEST(SettledStart, RefusesAtOnceGravityInWhichItWouldNotSettle) {
  BedParameters bed = settledBed();
  bed.gravity_m_s2 = {0, 0, -1e-3};
  std::string refusal = "taken";
  try {
    (void)settledTile(bed, {});
  } catch (const InvalidParameter& error) {
    refusal = error.what();
  }
  EXPECT_EQ(refusal.find("gravity_m_s2 = 0.001 is not valid: must be >= 0.01"), 0U) << refusal;
  bed.gravity_m_s2.z() = -1.02 * std::stod(refusal.substr(refusal.find(">= ") + 3));
  EXPECT_GT(settledTile(bed, {}).grains.size(), 100U) << "the least that it names is enough";
  BedParameters rain = bed;
  rain.start = BedStart::kRain;
  rain.particles = 300;
  rain.width_m = rain.length_m = 0.1;
  rain.gravity_m_s2 = {0, 0, -1e-4};
  EXPECT_THROW(Bed{rain}, InvalidParameter) << "it would hang in the air";
  rain.gravity_m_s2.setZero();
  EXPECT_EQ(Bed(rain).particles(), 300U) << "as weightless soil may";
}

TEST(SettledStart, ComesToRestWithoutFriction) {
  BedParameters bed = settledBed();
  bed.soil.contact_friction = 0;
  EXPECT_GT(settledTile(bed, {}).grains.size(), 100U);
}

TEST(SettledStart, HasEveryNeighbourItHadInItsTile) {
  const BedParameters parameters = settledBed();
  const BedTile tile = settledTile(parameters, {});
  const LaidSoil laid = laidOut(tile, parameters);
  const Bed bed(parameters);
  ASSERT_EQ(laid.free, bed.particles() - bed.heldParticles());
  const ContactLists& contacts = bed.state().contacts;
  std::vector<std::size_t> remembered(tile.grains.size());  // contacts of each of the tile's grains
  for (std::size_t i = 0; i < remembered.size(); ++i) {
    remembered[i] = tile.firsts[i + 1] - tile.firsts[i];
  }
  for (std::size_t i = 0; i < laid.free; ++i) {
    std::size_t own = 0;
    for (std::uint32_t s = 0; s < contacts.count(i); ++s) {
      const Slip slip = contacts.slip(i, s);
      own += slip.x != 0 || slip.y != 0 || slip.z != 0 ? 1 : 0;
    }
    ASSERT_EQ(own, remembered[laid.sources[i]]) << i;
  }
}

TEST(SettledStart, HoldsItsSidesWhateverHappensToTheSoil) {
  BedParameters parameters = settledBed();
  Bed bed(parameters);
  const std::size_t free = bed.particles() - bed.heldParticles();
  const std::vector<Float4> before = bed.state().position;
  bed.setGravity(Vec3(1.5, 1.0, -1));  // steeper than any soil bears
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(bed.step(stepOf(parameters)), StepStatus::kOk);
  }
  EXPECT_GT(bed.largestSpeed(), 0.05);
  const double held_m = heldWidth(parameters);
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Float4& p = bed.state().position[i];
    if (i >= free) {
      ASSERT_TRUE(p.x == before[i].x && p.y == before[i].y && p.z == before[i].z) << i;
    }
    ASSERT_LT(std::abs(p.x), parameters.width_m / 2 + held_m);
    ASSERT_LT(std::abs(p.y), parameters.length_m / 2 + held_m);
  }
  BedState freed = bed.state();
  freed.velocity[free].w = 0;
  EXPECT_THROW(Bed(parameters).restore(freed), InvalidParameter);
  BedState frozen = bed.state();
  frozen.rested[0] = BedState::kAsleepForEver;
  EXPECT_THROW(Bed(parameters).restore(frozen), InvalidParameter);
  const std::size_t still_held = bed.heldParticles();
  Bed again(parameters);
  again.restore(bed.state());
  EXPECT_EQ(again.heldParticles(), still_held);
  ASSERT_EQ(bed.step(stepOf(parameters)), StepStatus::kOk);
  again.setGravity(Vec3(1.5, 1.0, -1));
  ASSERT_EQ(again.step(stepOf(parameters)), StepStatus::kOk);
  EXPECT_EQ(stateHash(again.state()), stateHash(bed.state()));
}

TEST(SettledStart, SoilThatLayInABedLiesInAnother) {
  BedParameters parameters = settledBed();
  parameters.sleep_speed_m_s = 0;
  const Bed bed(parameters);
  const LyingSoil lying = bed.lying();
  ASSERT_GT(lying.held, 0U);
  Bed again(parameters, lying);
  EXPECT_EQ(again.heldParticles(), bed.heldParticles());
  again.setGravity(2 * parameters.gravity_m_s2);  // wakes all
  again.setGravity(parameters.gravity_m_s2);
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(again.step(stepOf(parameters)), StepStatus::kOk);
  }
  double farthest_m = 0;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Float4 &now = again.state().position[i], &then = lying.grains[i];
    ASSERT_EQ(now.w, then.w) << i;
    farthest_m = std::max<double>(farthest_m, std::hypot(now.x - then.x, now.y - then.y, now.z - then.z));
  }
  // A little, since contacts have forgotten what they had slipped.
  EXPECT_LT(farthest_m, 0.2 * parameters.soil.radius_m);
}

TEST(SettledStart, SoilThatIsThrownAgainstASideAboveItFalls) {
  BedParameters parameters = settledBed();
  parameters.sleep_speed_m_s = 0;
  parameters.soil.contact_cohesion_n = 0.1;  // holds fifty grains
  LyingSoil lying = Bed(parameters).lying();
  std::vector<std::size_t> topmost(lying.grains.size() - lying.held);
  std::iota(topmost.begin(), topmost.end(), 0U);
  std::ranges::sort(topmost, std::greater(), [&](std::size_t i) { return lying.grains[i].z; });
  constexpr std::size_t kThrown = 60;  // a block of 3 x 5 x 4 pressed against the side
  const double apart_m = 1.96 * parameters.soil.radius_m;
  const double wall_m = parameters.width_m / 2 + heldWidth(parameters);
  for (std::size_t n = 0; n < kThrown; ++n) {
    Float4& grain = lying.grains[topmost[n]];
    const auto place = [&](std::size_t along) { return static_cast<float>(apart_m * static_cast<double>(along)); };
    grain = {static_cast<float>(wall_m - apart_m / 2) - place(n % 3), place(n / 3 % 5), 0.15F + place(n / 15), 0};
  }
  Bed bed(parameters, lying);
  bed.setGravity(2 * parameters.gravity_m_s2);  // wakes all
  bed.setGravity(parameters.gravity_m_s2);
  for (double time_s = 0; time_s < 1; time_s += stepOf(parameters)) {
    ASSERT_EQ(bed.step(stepOf(parameters)), StepStatus::kOk);
  }
  double highest_m = 0;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    highest_m = std::max<double>(highest_m, bed.state().position[i].z);
  }
  EXPECT_LT(highest_m, 0.15) << "nothing hangs on a wall that nobody sees";
}

TEST(SettledStart, ComesToRestOnASlope) {
  BedParameters parameters = settledBed();
  parameters.gravity_m_s2 = Vec3(0.3, 0, -1.59);
  Bed bed(parameters);
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(bed.step(stepOf(parameters)), StepStatus::kOk);
  }
  EXPECT_LT(bed.largestSpeed(), 2e-3);
}

TEST(SettledStart, IsAtRestAndRemembersWhatCarriesIt) {
  BedParameters parameters = settledBed();
  Bed bed(parameters);
  EXPECT_EQ(bed.awake(), 0U);
  bed.setGravity(2 * parameters.gravity_m_s2);  // wakes all
  bed.setGravity(parameters.gravity_m_s2);
  const std::vector<Float4> before = bed.state().position;
  double fastest = 0;
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(bed.step(stepOf(parameters)), StepStatus::kOk);
    fastest = std::max(fastest, bed.largestSpeed());
  }
  // Half of its friction forgotten, soil sinks by millimetres a second; rounding of positions makes it shiver.
  EXPECT_LT(fastest, 3e-4);  // four seeds on three instruction sets: 1e-6 to 1.1e-4
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    EXPECT_NEAR(bed.state().position[i].z, before[i].z, 5e-6);  // 0.03 to 2.1 um
  }
}

TEST(SettledStart, IsTheSameForAnyNumberOfThreads) {
  BedParameters parameters = settledBed();
  const Bed one(parameters);
  parameters.threads = 2;
  const Bed two(parameters);
  EXPECT_EQ(stateHash(one.state()), stateHash(two.state()));
}

TEST(SettledStart, IsAnotherBedForAnotherSeed) {
  BedParameters parameters = settledBed();
  const Bed one(parameters);
  parameters.seed = 2;
  EXPECT_NE(stateHash(Bed(parameters).state()), stateHash(one.state()));
}

TEST(SettledStart, LiesStillUnderIcra2021Friction) {
  const BedParameters parameters = settledBed(FrictionModel::kIcra2021);
  Bed bed(parameters);
  bed.wake(0);
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(bed.step(stepOf(parameters)), StepStatus::kOk);
  }
  EXPECT_LT(bed.largestSpeed(), 1e-4);
}

TEST(SettledStart, FillsABoxThatRepeatsItselfWithWholeTilesWithoutASeam) {
  BedParameters parameters = settledBed();
  parameters.periodic_x = parameters.periodic_y = true;
  const BedTile tile = settledTile(parameters, {});
  EXPECT_DOUBLE_EQ(2 * tile.width_m, parameters.width_m);
  EXPECT_DOUBLE_EQ(2 * tile.length_m, parameters.length_m);
  const Bed bed(parameters);
  EXPECT_EQ(bed.particles(), 4 * tile.grains.size());
  // Nothing had to settle: each particle is in the place of its tile, exact except for the rounding of the shift.
  const LaidSoil laid = laidOut(tile, parameters);
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    EXPECT_EQ(bed.state().position[i].x, laid.grains[i].x);
    EXPECT_EQ(bed.state().position[i].z, tile.grains[laid.sources[i]].z);
  }
}

TEST(SettledStart, KeepsTheContactMemoryOfItsTile) {
  BedParameters parameters = settledBed();
  parameters.periodic_x = parameters.periodic_y = true;
  const BedTile tile = settledTile(parameters, {});
  const Bed bed(parameters);
  const ContactLists& contacts = bed.state().contacts;
  std::size_t remembered = 0;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    for (std::uint32_t s = 0; s < contacts.count(i); ++s) {
      const Slip slip = contacts.slip(i, s);
      remembered += slip.x != 0 || slip.y != 0 || slip.z != 0 ? 1 : 0;
    }
  }
  EXPECT_GT(tile.contacts.size(), 2 * tile.grains.size());
  EXPECT_EQ(remembered, 4 * tile.contacts.size());
}

TEST(SettledStart, DoesNotWaitForTheLastGrainToFindItsPlace) {
  double longest_s = 0;
  (void)settledTile(settledBed(), [&](double time_s, double) {
    longest_s = std::max(longest_s, time_s);
    return true;
  });
  EXPECT_LT(longest_s, 6);  // until none moved it took 19 to 34 s, for a bed as dense within 0.5 %
}

TEST(SettledStart, CanBeStoppedWhileItSettles) {
  EXPECT_THROW(Bed(settledBed(), [](double, double) { return false; }), Failure);
}

TEST(SettledStart, RefusesWhatCannotSettle) {
  BedParameters weightless = settledBed();
  weightless.gravity_m_s2 = Vec3::Zero();
  EXPECT_THROW(Bed{weightless}, InvalidParameter);
  BedParameters deep = settledBed();
  deep.depth_m = 100;
  EXPECT_THROW(Bed{deep}, std::exception);
  BedParameters wide = settledBed();
  wide.width_m = wide.length_m = 100;
  EXPECT_THROW(Bed{wide}, InvalidParameter);
}

}  // namespace
}  // namespace haptolith

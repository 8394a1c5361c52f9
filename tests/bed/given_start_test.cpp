// A bed whose particles have given positions, from a file or another program.

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using Grain = std::array<float, 4>;

BedParameters sand() {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.stiffness_n_m = 3000;
  bed.soil.gamma_nm = 6e-5;
  bed.soil.contact_friction = 0.3;
  bed.soil.contact_cohesion_n = 0.1;
  bed.soil.size_spread = 0.15;
  bed.start = BedStart::kSettled;
  bed.width_m = bed.length_m = 0.14;
  bed.depth_m = 0.06;
  return bed;
}

/// The grains of one bed as those of another.
BedParameters givenBy(const Bed& bed) {
  BedParameters parameters = bed.parameters();
  const LyingSoil lying = bed.lying();
  std::vector<Grain> grains;
  for (const Float4& grain : lying.grains) {
    grains.push_back({grain.x, grain.y, grain.z, grain.w});
  }
  parameters.start = BedStart::kGiven;
  parameters.given = {std::make_shared<const std::vector<Grain>>(grains), lying.held, "somebody's"};
  return parameters;
}

BedParameters givenOf(std::vector<Grain> grains) {
  BedParameters parameters = sand();
  parameters.start = BedStart::kGiven;
  parameters.given.grains = std::make_shared<const std::vector<Grain>>(std::move(grains));
  return parameters;
}

double meanHeight(const Bed& bed) {
  double sum = 0;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    sum += bed.state().position[i].z;
  }
  return sum / static_cast<double>(bed.particles());
}

TEST(GivenStart, LiesStillAndAsDense) {
  const Bed settled(sand());
  Bed again(givenBy(settled));
  EXPECT_EQ(again.particles(), settled.particles());
  EXPECT_EQ(again.heldParticles(), settled.heldParticles());
  EXPECT_GT(again.heldParticles(), 0U);
  // The slip of its contacts was cleared, and built up again.
  EXPECT_NEAR(meanHeight(again) / meanHeight(settled), 1, 0.01);
  const double began_m = meanHeight(again);
  again.wake(0);
  const double dt = again.parameters().tick_s / substepsFor(again.parameters(), 0);
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(again.step(dt), StepStatus::kOk);
    ASSERT_LT(again.largestSpeed(), 1e-4);
  }
  EXPECT_NEAR(meanHeight(again), began_m, 1e-6);
}

TEST(GivenStart, GivesTheSameForAnyNumberOfThreadsAndAgain) {
  const BedParameters parameters = givenBy(Bed(sand()));
  BedParameters with_two = parameters;
  with_two.threads = 2;
  EXPECT_EQ(Bed(parameters).hash(), Bed(with_two).hash());
}

TEST(GivenStart, GoesOnFromASavedBed) {
  Bed bed(givenBy(Bed(sand())));
  const double dt = bed.parameters().tick_s / substepsFor(bed.parameters(), 0);
  (void)bed.step(dt);
  Bed again(bed.parameters(), bed.save());
  EXPECT_EQ(again.heldParticles(), bed.heldParticles());
  (void)bed.step(dt);
  (void)again.step(dt);
  EXPECT_EQ(bed.hash(), again.hash());
}

TEST(GivenStart, LetsWhatHangsInTheAirFall) {
  const Bed bed(givenOf({{0, 0, 0.007F, 0}, {0.03F, 0, 0.05F, 0.001F}}));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT(bed.state().position[i].z, 0.0085F);
  }
}

TEST(GivenStart, RefusesWhatCannotBe) {
  EXPECT_THROW(Bed{givenOf({})}, InvalidParameter);
  EXPECT_THROW(Bed{givenOf({{0.2F, 0, 0.01F, 0}})}, InvalidParameter) << "beside the box";
  EXPECT_THROW(Bed{givenOf({{0, 0, -0.01F, 0}})}, InvalidParameter) << "under the floor";
  EXPECT_THROW(Bed{givenOf({{0, 0, 0.01F, 0.002F}})}, InvalidParameter) << "larger than any";
  EXPECT_THROW(Bed{givenOf({{0, std::numeric_limits<float>::quiet_NaN(), 0.01F, 0}})}, InvalidParameter);
  BedParameters all_held = givenOf({{0, 0, 0.01F, 0}});
  all_held.given.held = 1;
  EXPECT_THROW(Bed{all_held}, InvalidParameter);
  BedParameters icra2021 = givenOf({{0, 0, 0.01F, 0.0001F}});
  icra2021.soil.friction = FrictionModel::kIcra2021;
  EXPECT_THROW(Bed{icra2021}, InvalidParameter) << "the paper's grains are all alike";
}

std::string refusalOf(const BedParameters& bed) {
  try {
    validate(bed);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "taken";
}

TEST(GivenStart, NamesGrainsThatAreInEachOther) {
  using testing::AllOf;
  using testing::HasSubstr;
  EXPECT_EQ(refusalOf(givenOf({{0, 0, 0.01F, 0}, {0, 0, 0.02F, 0}})), "taken") << "pressed hard";
  EXPECT_THAT(refusalOf(givenOf({{0.05F, 0, 0.01F, 0}, {0, 0, 0.01F, 0}, {0.05F, 0, 0.01F, 0}})),
              AllOf(HasSubstr("numbers 1 and 3"), HasSubstr("at the same place")));
  EXPECT_THAT(refusalOf(givenOf({{0, 0, 0.01F, 0}, {0.002F, 0, 0.01F, 0.001F}})),
              AllOf(HasSubstr("numbers 1 and 2"), HasSubstr("0.002 m apart"), HasSubstr("at least 0.008 m apart")));
  BedParameters round = givenOf({{0.0695F, 0.03F, 0.01F, 0}, {-0.0695F, 0.03F, 0.01F, 0}});
  EXPECT_EQ(refusalOf(round), "taken");
  round.periodic_x = true;
  EXPECT_THAT(refusalOf(round), HasSubstr("0.001 m apart")) << "on both sides of where the box repeats itself";
}

TEST(GivenStart, LooksAtAHundredThousandGrainsInLessThanASecond) {
  BedParameters bed = sand();
  bed.width_m = bed.length_m = 2;
  std::vector<Grain> grains;
  for (int i = 0; i < 100'000; ++i) {
    const auto at = [](int k) { return 0.0125F * static_cast<float>(k); };
    grains.push_back({at(i % 100) - 0.6F, at(i / 100 % 100) - 0.6F, at(i / 10'000 + 1), 0});
  }
  bed.start = BedStart::kGiven;
  bed.given.grains = std::make_shared<const std::vector<Grain>>(grains);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(refusalOf(bed), "taken");
  grains.push_back(grains[70'000]);
  bed.given.grains = std::make_shared<const std::vector<Grain>>(grains);
  EXPECT_THAT(refusalOf(bed), testing::HasSubstr("numbers 70001 and 100001"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2)) << "twice";
}

TEST(GivenGrains, AreComparedByTheirNumbers) {
  const BedParameters one = givenOf({{0, 0, 0.01F, 0}}), same = givenOf({{0, 0, 0.01F, 0}});
  const BedParameters other = givenOf({{0, 0, 0.02F, 0}});
  EXPECT_TRUE(one.given == same.given);
  EXPECT_FALSE(one.given == other.given);
  EXPECT_FALSE(one.given == GivenGrains{});
  EXPECT_TRUE(GivenGrains{} == GivenGrains{});
}

}  // namespace
}  // namespace haptolith

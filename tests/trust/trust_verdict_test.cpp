#include "haptolith/trust/trust_verdict.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Forces of a tool with room everywhere.
TrustForce forceOf(double mean_n, double peak_n) {
  return {.mean_n = mean_n,
          .peak_n = peak_n,
          .reach = {.depth_m = 0.01, .to_floor_m = 0.2, .to_wall_x_m = 0.2, .to_wall_y_m = 0.2}};
}

TrustForces rowOf(TrustChange change, const std::vector<double>& mean_n, double radius_ratio = 1) {
  TrustForces row{.change = change, .radius_ratio = radius_ratio, .specimens = {}, .why_not = {}};
  for (const double mean : mean_n) {
    row.specimens.emplace_back(forceOf(mean, 3 * mean));
  }
  return row;
}

SceneFile sceneOf() {
  SceneFile scene = findSceneFile("icra2021");
  scene.bed.soil.radius_m = 1e-3;
  return scene;
}

TEST(TrustVerdict, IsTightWhereNothingChangesTheForce) {
  const TrustVerdict verdict = judgeTrust(sceneOf(), {rowOf(TrustChange::kNone, {1.00, 1.01, 0.99, 1.02, 0.98}),
                                                      rowOf(TrustChange::kWideX, {1.00, 1.01, 0.99, 1.02, 0.98})});
  EXPECT_NEAR(verdict.within_mean, 2.132 * 0.01581 * std::sqrt(1.2), 1e-4) << "Student's t of 4 degrees of freedom";
  EXPECT_THAT(verdict.complaints, IsEmpty());
  EXPECT_EQ(verdict.sentence, "Mean force within 4 %, peak within 4 %.");
}

TEST(TrustVerdict, SaysWhatIsFelt) {
  const std::vector<double> usual{1.00, 1.01, 0.99, 1.02, 0.98};
  const auto judged = [&](TrustChange change, double factor, double ratio = 1) {
    std::vector<double> changed;
    for (const double mean : usual) {
      changed.push_back(factor * mean);
    }
    return judgeTrust(sceneOf(), {rowOf(TrustChange::kNone, usual), rowOf(change, changed, ratio)});
  };
  EXPECT_THAT(judged(TrustChange::kWideX, 0.8).sentence, HasSubstr("the box is too narrow along x"));
  EXPECT_THAT(judged(TrustChange::kWideY, 1.2).sentence, HasSubstr("the box is too narrow along y"));
  EXPECT_THAT(judged(TrustChange::kDeep, 0.8).sentence,
              AllOf(HasSubstr("the floor is felt"), HasSubstr("probably too high by 20 %")));
  EXPECT_THAT(judged(TrustChange::kStep, 0.8).sentence,
              AllOf(HasSubstr("the step is too long"), Not(HasSubstr("probably"))));
  EXPECT_THAT(judged(TrustChange::kStiff, 1.05).complaints, IsEmpty());
  // The effect of 1.5 times the radius predicts that of half of it, by a straight line.
  EXPECT_THAT(judged(TrustChange::kRadius, 0.8, 1.5).sentence,
              AllOf(HasSubstr("the particles are too large"), HasSubstr("probably too low by 20 %")));
  EXPECT_GE(judged(TrustChange::kRadius, 0.8, 1.5).within_mean, 0.2);
  EXPECT_NEAR(judged(TrustChange::kRadius, 0.8, 1.5).within_mean, judged(TrustChange::kRadius, 1.2, 0.5).within_mean,
              1e-9);
}

TEST(TrustVerdict, LooksAtTheRoomAsWell) {
  std::vector<TrustForces> rows{rowOf(TrustChange::kNone, {1.0, 1.02})};
  for (auto& force : rows[0].specimens) {
    force->reach.to_wall_x_m = force->reach.to_wall_y_m = 0.005;
    force->reach.to_floor_m = 0.005;
  }
  EXPECT_THAT(judgeTrust(sceneOf(), rows).complaints,
              AllOf(Contains("the box is too narrow along x and y"), Contains("the floor is felt")));
  SceneFile periodic = sceneOf();
  periodic.bed.periodic_x = periodic.bed.periodic_y = true;
  EXPECT_THAT(judgeTrust(periodic, rows).complaints, Not(Contains(HasSubstr("narrow"))));
  // A good measurement counts more than a rule.
  rows.push_back(rowOf(TrustChange::kWideX, {1.0, 1.02}));
  const TrustVerdict measured = judgeTrust(sceneOf(), rows);
  EXPECT_THAT(measured.complaints, Contains("the box is too narrow along y"));
  EXPECT_THAT(measured.sentence, HasSubstr("near, but not felt: the walls along x."));
}

TEST(TrustVerdict, NamesWeakSoil) {
  const std::vector<TrustForces> rows{rowOf(TrustChange::kNone, {1.0, 1.02})};
  const auto complaints = [&](double shown_deg, double shown_pa) {
    return judgeTrust(sceneOf(), rows,
                      TrustStrength{.asked_deg = 42,
                                    .shown_deg = shown_deg,
                                    .error_deg = 0.5,
                                    .asked_pa = 500,
                                    .shown_pa = shown_pa,
                                    .error_pa = 20})
        .complaints;
  };
  EXPECT_THAT(complaints(41, 550), IsEmpty());
  EXPECT_THAT(complaints(30, 550), Contains("the soil is not as strong as asked for"));
  EXPECT_THAT(complaints(42, 200), Contains("the soil is not as strong as asked for"));
}

TEST(TrustVerdict, HasNothingToSayOfNoForce) {
  const TrustVerdict verdict = judgeTrust(sceneOf(), {rowOf(TrustChange::kNone, {0, 0, 0})});
  EXPECT_THAT(verdict.sentence, HasSubstr("does not touch the soil"));
  EXPECT_THAT(trustText(verdict), HasSubstr("does not touch the soil"));
}

TEST(TrustVerdict, TellsWhatWasLeftOut) {
  TrustForces left_out{
      .change = TrustChange::kMesh, .radius_ratio = 1, .specimens = {}, .why_not = "no mesh is made of this shape"};
  const TrustVerdict verdict = judgeTrust(sceneOf(), {rowOf(TrustChange::kNone, {1.0, 1.02}), left_out});
  EXPECT_THAT(trustText(verdict), HasSubstr("not simulated: no mesh is made of this shape"));
  EXPECT_EQ(trustJson(verdict).at("effects").at(0).at("why_not"), "no mesh is made of this shape");
}

TEST(TrustVerdict, WantsTwoSpecimens) {
  EXPECT_THROW((void)judgeTrust(sceneOf(), {rowOf(TrustChange::kNone, {1.0})}), InvalidParameter);
}

// The bound holds for a single specimen against the mean of five others in the limit, for many simulated scenes of any
// scatter and any shifts.
TEST(TrustVerdict, TheBoundHoldsNineTimesInTenOrMore) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(random); };
  int held = 0, without_shift = 0;
  constexpr int kScenes = 4000;
  for (int i = 0; i < kScenes; ++i) {
    const bool shifted = i % 2 == 1;
    const double scatter = 0.02 + 0.1 * std::abs(draw());
    const double box = shifted ? 0.1 * draw() : 0, radius = shifted ? 0.2 * draw() : 0;
    const auto specimens = [&](double shift, int n) {
      std::vector<double> means;
      for (int k = 0; k < n; ++k) {
        means.push_back(std::max(0.01, (1 + shift) * (1 + scatter * draw())));
      }
      return means;
    };
    const TrustVerdict verdict = judgeTrust(
        sceneOf(), {rowOf(TrustChange::kNone, specimens(0, 5)), rowOf(TrustChange::kWideX, specimens(box, 5)),
                    rowOf(TrustChange::kWideY, specimens(0, 5)), rowOf(TrustChange::kDeep, specimens(0, 5)),
                    rowOf(TrustChange::kRadius, specimens(radius, 5), 0.5)});
    double limit = 0;
    for (const double mean : specimens(box + radius, 5)) {
      limit += mean / 5;
    }
    const double one = specimens(0, 1).front();
    const bool holds = std::abs(limit - one) <= verdict.within_mean * verdict.mean_n;
    held += holds ? 1 : 0;
    without_shift += holds && !shifted ? 1 : 0;
  }
  EXPECT_GT(held, 0.9 * kScenes);
  EXPECT_LT(held, 0.995 * kScenes) << "wider than it need be";
  EXPECT_GT(without_shift, 0.9 * kScenes / 2);
}

}  // namespace
}  // namespace haptolith

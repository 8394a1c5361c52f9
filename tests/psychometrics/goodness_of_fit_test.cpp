#include "haptolith/psychometrics/goodness_of_fit.h"

#include <gmock/gmock.h>

#include <cmath>

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Mean of k/n of many drawn levels, and their variance over that of binomial ones.
struct Drawn {
  double mean = 0, dispersion = 0;
};

Drawn drawn(double n, double psi, double eta) {
  constexpr int kDraws = 4000;
  PsychometricFunction flat;  // far above its threshold
  flat.lapse = 1 - psi;
  const std::vector<Level> levels(kDraws, Level{1e6, 0, n});
  std::mt19937_64 random(3);
  Drawn of;
  double square = 0;
  for (const Level& level : simulatedAnswers(levels, flat, random, eta)) {
    EXPECT_GE(level.k, 0);
    EXPECT_LE(level.k, n);
    EXPECT_EQ(level.k, std::floor(level.k));
    of.mean += level.k / n / kDraws;
    square += level.k / n * level.k / n / kDraws;
  }
  of.dispersion = (square - of.mean * of.mean) / (psi * (1 - psi) / n);
  return of;
}

// The variance of k/n is that of binomial answers times 1 + (n - 1) eta^2.
TEST(SimulatedAnswers, AreBetaBinomialHoweverManyThereAre) {
  for (const double n : {50.0, 101.0, 5000.0, 1e9}) {
    for (const double psi : {0.02, 0.5, 0.9}) {
      for (const double eta : {0.0, 0.05, 0.6}) {
        const Drawn of = drawn(n, psi, eta);
        const double dispersion = 1 + (n - 1) * eta * eta;
        const double kurtosis = 3 + 1 / (psi * (1 - psi));  // at most, where all answers are alike
        EXPECT_NEAR(of.dispersion / dispersion, 1, 4 * std::sqrt(kurtosis / 4000)) << n << " " << psi << " " << eta;
        EXPECT_NEAR(of.mean, psi, 4 * std::sqrt(psi * (1 - psi) / n * dispersion / 4000))
            << n << " " << psi << " " << eta;
      }
    }
  }
}

TEST(SimulatedAnswers, OfACertainStimulusAreCertain) {
  EXPECT_NEAR(drawn(1e9, 1, 0.5).mean, 1, 1e-9);
  EXPECT_NEAR(drawn(1e9, 0.3, 1 - 1e-9).mean, 0.3, 0.03) << "all answers alike";
}

TEST(Doubt, IsToldOfAnswersThatRunTheOtherWay) {
  const std::vector<Level> falling{{.5, 20, 20}, {.7, 18, 20}, {.9, 10, 20}, {1.1, 2, 20}, {1.3, 0, 20}};
  EXPECT_THAT(doubtOf(falling, {}), HasSubstr("become fewer for larger stimuli: fit a falling one, --falling?"));
  EXPECT_THAT(doubtOf(falling, {.falling = true}), IsEmpty());
  const std::vector<Level> rising{{.5, 0, 20}, {.7, 2, 20}, {.9, 10, 20}, {1.1, 18, 20}};
  EXPECT_THAT(doubtOf(rising, {}), IsEmpty());
  EXPECT_THAT(doubtOf(rising, {.falling = true}), HasSubstr("without --falling"));
  EXPECT_THAT(doubtOf(std::vector<Level>{{1, 3, 20}, {2, 1, 20}}, {}), IsEmpty()) << "chance";
  EXPECT_THAT(doubtOf(std::vector<Level>{{1, 0, 20}, {2, 0, 20}}, {}), IsEmpty()) << "as good as any other way";
}

TEST(Doubt, IsToldOfFewerRightAnswersThanByGuessing) {
  const FitOptions two{.design = Design::kForcedChoice};
  EXPECT_THAT(doubtOf(std::vector<Level>{{1, 0, 20}, {2, 0, 20}}, two),
              HasSubstr("0 of 40 responses are correct, and guessing gives 1 of 2"));
  EXPECT_THAT(doubtOf(std::vector<Level>{{1, 8, 20}, {2, 9, 20}}, two), IsEmpty());
}

}  // namespace
}  // namespace haptolith

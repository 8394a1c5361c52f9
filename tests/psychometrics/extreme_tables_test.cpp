// Tables of answers at their extremes: every estimate is a number inside its interval, or says why not.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/fit_json.h"
#include "haptolith/psychometrics/group/group.h"

namespace haptolith {
namespace {

using Random = std::mt19937_64;

double drawnBelow(Random& random, double end) {
  return std::floor(end * std::uniform_real_distribution<>(0, 1)(random));
}

/// One to six stimuli, in one of many scales, some of which differ by rounding; all right, all wrong, a step up or
/// down, or anything; one answer to a level or up to a million.
std::vector<Level> drawnTable(Random& random, bool above_zero) {
  static constexpr std::array kScales{1e-50, 1e-9, 1e-3, 1.0, 1.0, 1.0, 1e6, 1e30};
  static constexpr std::array kAnswers{1.0, 3.0, 20.0, 20.0, 1e3, 1e6};
  const double scale = kScales[static_cast<std::size_t>(drawnBelow(random, kScales.size()))];
  const double n = kAnswers[static_cast<std::size_t>(drawnBelow(random, kAnswers.size()))];
  const double offset = above_zero ? 0 : drawnBelow(random, 3) - 1;
  const int kind = static_cast<int>(drawnBelow(random, 6));
  std::vector<Level> levels;
  double x = scale * (offset + 0.1);
  for (double left = 1 + drawnBelow(random, 6); left > 0; --left) {
    const bool rounding = drawnBelow(random, 6) == 0;
    x = rounding ? std::nextafter(x, 1e300) : x + scale * (0.05 + drawnBelow(random, 10) / 10);
    const bool high = x > scale * (offset + 1);
    const double k = kind == 0   ? n
                     : kind == 1 ? 0
                     : kind == 2 ? (high ? n : 0)
                     : kind == 3 ? (high ? 0 : n)
                                 : drawnBelow(random, n + 1);
    levels.push_back({x, k, n});
  }
  return levels;
}

std::string tableText(const std::vector<Level>& levels) {
  std::string text;
  for (const Level& level : levels) {
    text += fmt::format("{},{:.0f},{:.0f}; ", level.x, level.k, level.n);
  }
  return text;
}

void expectSound(const Fit& fit, const std::string& what, bool of_group = false) {
  const nlohmann::ordered_json json = fitJson(fit);
  const auto at_edge = [&](const char* name) {
    return json.contains("at_edge") && std::ranges::find(json["at_edge"], name) != json["at_edge"].end();
  };
  const auto expect_inside = [&](const char* name, const Estimate& estimate) {
    const auto& [low, high] = estimate.interval;
    EXPECT_TRUE(std::isfinite(estimate.value)) << name << " of " << what;
    EXPECT_TRUE(low <= high) << name << " of " << what << ": " << low << " to " << high;
    EXPECT_TRUE((low <= estimate.value && estimate.value <= high) || at_edge(name))
        << name << " of " << what << ": " << estimate.value << " in " << low << " to " << high;
  };
  expect_inside("threshold", fit.threshold);
  expect_inside("width", fit.width);
  expect_inside("jnd", fit.jnd);
  if (!std::isnan(fit.weber_fraction.value)) {
    expect_inside("weber_fraction", fit.weber_fraction);
  } else {
    EXPECT_FALSE(fit.function.log_axis) << what;
    EXPECT_LE(fit.threshold.interval.low, 0) << what;
  }
  expect_inside("lapse", fit.lapse);
  if (!of_group) {  // both are individual
    expect_inside("guess", fit.guess);
    expect_inside("overdispersion", fit.overdispersion);
  }
  EXPECT_GE(fit.deviance, 0) << what;
  EXPECT_FALSE(std::isnan(fit.log_likelihood)) << what;
}

/// Draws tables and fits each that is not refused. @return how many were fitted.
template <class FitTable>
int fitTables(int tables, bool above_zero, const FitTable& fit_table) {
  Random random(11);
  int fitted = 0;
  for (int i = 0; i < tables; ++i) {
    const std::vector<Level> levels = drawnTable(random, above_zero);
    try {
      fit_table(levels, fmt::format("table {}: {}", i, tableText(levels)));
      ++fitted;
    } catch (const InvalidParameter& error) {  // all answers to one stimulus
      EXPECT_THAT(error.what(), testing::HasSubstr("two or more stimuli")) << tableText(levels);
    }
  }
  return fitted;
}

TEST(ExtremeTables, GiveAnEstimateInsideItsIntervalByWeberAlone) {
  FitOptions options = weberOptions(1);
  options.simulations = 0;
  const int fitted = fitTables(300, true, [&](const std::vector<Level>& levels, const std::string& what) {
    options.threshold = levels.front().x;
    expectSound(fitPsychometric(levels, options), what);
  });
  EXPECT_GT(fitted, 200);
}

TEST(ExtremeTables, GiveAnEstimateInsideItsIntervalOnALinearAxis) {
  const FitOptions options{.sigmoid = Sigmoid::kNorm,
                           .design = Design::kEqualAsymptote,
                           .overdispersion = 0,
                           .estimate = PointEstimate::kMedian,
                           .simulations = 0};
  const int fitted = fitTables(300, false, [&](const std::vector<Level>& levels, const std::string& what) {
    expectSound(fitPsychometric(levels, options), what);
  });
  EXPECT_GT(fitted, 200);
}

TEST(ExtremeTables, GiveAMostProbableEstimateInsideItsIntervalOrTellThatItIsAtAnEdge) {
  FitOptions options{
      .sigmoid = Sigmoid::kLogistic, .design = Design::kForcedChoice, .log_axis = true, .overdispersion = 0};
  options.simulations = 0;
  const int fitted = fitTables(150, true, [&](const std::vector<Level>& levels, const std::string& what) {
    expectSound(fitPsychometric(levels, options), what);
  });
  EXPECT_GT(fitted, 100);
}

TEST(ExtremeTables, GiveGroupsAnEstimateInsideItsInterval) {
  FitOptions options = weberOptions(1);
  options.threshold.reset();
  Random random(12);
  int fitted = 0;
  for (int table = 0; table < 60; ++table) {
    std::vector<std::vector<Level>> people(1 + static_cast<std::size_t>(drawnBelow(random, 4)));
    const std::vector<Level> first = drawnTable(random, true);
    std::string what = fmt::format("table {}: ", table);
    for (std::vector<Level>& person : people) {
      person = first;  // equal stimuli, other responses
      const double kind = drawnBelow(random, 4);
      for (Level& level : person) {
        level.k = kind == 0 ? 0 : kind == 1 ? level.n : kind == 2 ? level.k : drawnBelow(random, level.n + 1);
      }
      what += tableText(person) + " | ";
    }
    try {
      const GroupFit group = fitGroup(people, groupOptions(options), Effort::kQuick);
      expectSound(group.median_person, what, true);
      EXPECT_GE(group.scale.alike, 0) << what;
      EXPECT_TRUE(std::isfinite(group.scale.alike)) << what;
      EXPECT_TRUE(std::isfinite(group.threshold->alike)) << what;
      ++fitted;
    } catch (const InvalidParameter& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("two or more stimuli")) << what;
    }
  }
  EXPECT_GT(fitted, 30);
}

TEST(ExtremeTables, BeyondTheRangeOfNumbersAreRefused) {
  const FitOptions logarithmic{.sigmoid = Sigmoid::kGumbel, .log_axis = true};
  for (const std::vector<Level>& levels :
       {std::vector<Level>{{-1e308, 1, 20}, {1e308, 19, 20}}, {{1e-300, 3, 20}, {2e-300, 17, 20}}}) {
    EXPECT_THROW((void)fitPsychometric(levels, {}), InvalidParameter);
  }
  EXPECT_THROW((void)fitPsychometric(std::vector<Level>{{1e-300, 3, 20}, {1, 17, 20}}, logarithmic), InvalidParameter);
}

}  // namespace
}  // namespace haptolith

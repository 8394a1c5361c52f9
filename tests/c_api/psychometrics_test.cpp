#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/fit_json.h"

#include "use.h"

namespace haptolith::library {
namespace {

using testing::HasSubstr;

/// Stimulus, positive answers, answers.
const std::vector<double> kAnswers{0.6, 3, 20, 0.7, 6, 20, 0.8, 9, 20, 0.9, 12, 20, 1.0, 15, 20, 1.1, 18, 20};

std::vector<Level> levels() {
  std::vector<Level> levels;
  for (std::size_t i = 0; i < kAnswers.size(); i += 3) {
    levels.push_back({kAnswers[i], kAnswers[i + 1], kAnswers[i + 2]});
  }
  return levels;
}

ResultPtr fitted(const char* options) {
  hapto_result* result = nullptr;
  expectOk(hapto_psychometric_fit(kAnswers.data(), kAnswers.size() / 3, options, &result));
  return ResultPtr(result);
}

nlohmann::json jsonOf(const hapto_result* result) {
  const char* text = nullptr;
  expectOk(hapto_result_json(result, &text));
  return nlohmann::json::parse(text);
}

TEST(LibraryPsychometrics, FitsAsInside) {
  const ResultPtr weber = fitted("reference = 0.835\nsimulations = 200\n");
  FitOptions options = weberOptions(0.835);
  options.design = Design::kEqualAsymptote;
  options.simulations = 200;
  nlohmann::json inside = nlohmann::json::parse(fitJson(fitPsychometric(levels(), options)).dump());
  nlohmann::json outside = jsonOf(weber.get());
  outside.erase("columns");
  EXPECT_EQ(outside, inside);

  const ResultPtr free = fitted("sigmoid = 'norm'\ndesign = 'yesno'\nlapse = 0.02\nguess = 'free'\nmethod = 'ml'\n");
  const nlohmann::json told = jsonOf(free.get());
  EXPECT_EQ(told["method"], "ml");
  EXPECT_EQ(told["lapse"], 0.02);
  EXPECT_GT(told["guess"], 0);
}

TEST(LibraryPsychometrics, TellsTheCurveAndItsBand) {
  const ResultPtr result = fitted("sigmoid = 'logistic'\nsimulations = 0\n");
  std::vector<std::vector<double>> columns;
  for (const char* name : {"x", "psi_low", "psi", "psi_high"}) {
    auto array = sized<hapto_array>();
    expectOk(hapto_result_column(result.get(), name, &array));
    const auto* numbers = static_cast<const double*>(array.data);
    columns.emplace_back(numbers, numbers + array.count);
  }
  ASSERT_EQ(columns[0].size(), 101U);
  EXPECT_DOUBLE_EQ(columns[0].front(), 0.55);
  EXPECT_DOUBLE_EQ(columns[0].back(), 1.15);
  for (std::size_t i = 0; i < columns[0].size(); ++i) {
    EXPECT_LE(columns[1][i], columns[2][i]);
    EXPECT_LE(columns[2][i], columns[3][i]);
  }
}

TEST(LibraryPsychometrics, RefusesWhatMakesNoSense) {
  hapto_result* result = nullptr;
  const auto refused = [&](const char* options, const std::vector<double>& answers) {
    EXPECT_EQ(hapto_psychometric_fit(answers.data(), answers.size() / 3, options, &result), HAPTO_INVALID_PARAMETER);
    return std::string(lastError().message);
  };
  EXPECT_THAT(refused("sigmoid = 'steep'", kAnswers), HasSubstr("norm or logistic"));
  EXPECT_THAT(refused("alternatives = 3", kAnswers), HasSubstr("only with design nafc"));
  EXPECT_THAT(refused("lapse = 'much'", kAnswers), HasSubstr("a number or free"));
  EXPECT_THAT(refused("sigmoyd = 'norm'", kAnswers), HasSubstr("did you mean sigmoid?"));
  EXPECT_THAT(refused("", {1, 5, 3}), HasSubstr("k"));
  EXPECT_FALSE(refused("confidence = 2", kAnswers).empty());
  EXPECT_FALSE(refused("", {1, 0, 0}).empty());
}

}  // namespace
}  // namespace haptolith::library

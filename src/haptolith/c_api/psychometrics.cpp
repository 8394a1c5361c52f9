// Psychometric functions, fitted to answers.

#include <fmt/format.h>
#include <haptolith/haptolith.h>

#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/result.h"
#include "haptolith/c_api/values.h"
#include "haptolith/core/error.h"
#include "haptolith/lab/catalogue/option_reader.h"
#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/fit_json.h"
#include "haptolith/psychometrics/fit_request.h"

using namespace haptolith;
using namespace haptolith::library;

namespace {

std::vector<LabOption> optionsOf(FitRequest& asked, double& pool_tolerance) {
  const auto word = [](const char* key, std::vector<std::string> words, std::string& to) {
    return wordOption(
        key, std::move(words), to, [&to](std::string_view given) { to = given; }, "");
  };
  const auto on = [](const char* key, bool& to) {
    return LabOption{.key = key, .help = "", .usual = "", .set = LabOption::Switch([&to] { to = true; })};
  };
  const LabOption reference{.key = "reference", .help = "", .usual = "", .set = LabOption::Number([&asked](double p) {
                                                                           asked.reference = p;
                                                                         })};
  return {word("design", designNames(), asked.design),
          word("sigmoid", sigmoidNames(), asked.sigmoid),
          word("method", {"map", "median", "ml"}, asked.method),
          textOption("lapse", asked.lapse, ""),
          textOption("guess", asked.guess, ""),
          textOption("overdispersion", asked.overdispersion, ""),
          countOption("alternatives", asked.alternatives, {2, 1000}, ""),
          on("log_x", asked.log_x),
          on("falling", asked.falling),
          on("free_threshold", asked.free_threshold),
          reference,
          numberOption("confidence", asked.confidence, ""),
          countOption("simulations", asked.simulations, {0, 1e6}, ""),
          numberOption("pool_tolerance", pool_tolerance, "")};
}

/// The function and its band, a little beyond the levels.
void addCurve(const Fit& fit, Result& result) {
  constexpr int kPoints = 101;
  constexpr double kBeyond = 0.1;  // fraction of the levels' range
  const bool log_axis = fit.function.log_axis;
  const auto on_axis = [log_axis](double x) { return log_axis ? std::log(x) : x; };
  const double low = on_axis(fit.levels.front().x);
  const double high = on_axis(fit.levels.back().x);
  std::vector<double> x;
  std::vector<double> psi;
  for (int i = 0; i < kPoints; ++i) {
    const double share = (1 + 2 * kBeyond) * i / (kPoints - 1) - kBeyond;
    const double at = low + share * (high - low);
    x.push_back(log_axis ? std::exp(at) : at);
    psi.push_back(probability(fit.function, x.back()));
  }
  const std::vector<Interval> band = credibleBand(fit, x);
  std::vector<double> below;
  std::vector<double> above;
  for (const Interval& interval : band) {
    below.push_back(interval.low);
    above.push_back(interval.high);
  }
  result.names = {"x", "psi", "psi_low", "psi_high"};
  result.columns = {x, psi, below, above};
}

}  // namespace

std::int32_t hapto_psychometric_fit(const double* levels, std::uint64_t count, const char* options,
                                    hapto_result** out) {
  if (levels == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, levels == nullptr ? "levels" : "out");
  }
  return guarded([&] {
    constexpr std::uint64_t kMost = 1'000'000;
    if (count > kMost) {
      throw InvalidParameter("count", std::to_string(count), fmt::format("at most {}", kMost));
    }
    FitRequest asked;
    double pool_tolerance = 0;
    readOptions(textOrNothing(options), optionsOf(asked, pool_tolerance));
    std::vector<Level> answers;
    for (std::uint64_t i = 0; i < count; ++i) {
      answers.push_back({levels[3 * i], levels[3 * i + 1], levels[3 * i + 2]});
    }
    answers = pool_tolerance == 0 ? pooled(answers) : pooledWithin(answers, pool_tolerance);
    const Fit fit = fitAsAsked(answers, asked, "");
    Result result{.json = fitJson(fit)};
    addCurve(fit, result);
    *out = handleOf(std::move(result));
    return std::int32_t{HAPTO_OK};
  });
}

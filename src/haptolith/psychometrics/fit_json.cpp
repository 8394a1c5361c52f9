#include "haptolith/psychometrics/fit_json.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string_view>
#include <utility>

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

std::string_view nameOf(FitMethod method) {
  switch (method) {
    case FitMethod::kMedian: return "median";
    case FitMethod::kMaximumLikelihood: return "ml";
    case FitMethod::kMap: break;
  }
  return "map";
}

}  // namespace

Json intervalJson(const Interval& interval) {
  return Json::array({interval.low, interval.high});
}

std::string designName(const Fit& fit) {
  return fit.design == Design::kForcedChoice ? fmt::format("{}afc", fit.alternatives) : std::string(nameOf(fit.design));
}

Json fitJson(const Fit& fit) {
  Json json{{"threshold", fit.threshold.value},
            {"width", fit.width.value},
            {"jnd", fit.jnd.value},
            {"weber_fraction", fit.weber_fraction.value},
            {"lapse", fit.lapse.value},
            {"guess", fit.guess.value},
            {"overdispersion", fit.overdispersion.value},
            {"intervals",
             {{"threshold", intervalJson(fit.threshold.interval)},
              {"width", intervalJson(fit.width.interval)},
              {"jnd", intervalJson(fit.jnd.interval)},
              {"weber_fraction", intervalJson(fit.weber_fraction.interval)},
              {"lapse", intervalJson(fit.lapse.interval)},
              {"guess", intervalJson(fit.guess.interval)},
              {"overdispersion", intervalJson(fit.overdispersion.interval)}}},
            {"confidence", fit.confidence},
            {"deviance", fit.deviance},
            {"p_value", fit.p_value},
            {"p_value_chi_square", fit.p_value_chi_square},
            {"n_trials", std::llround(fit.n_trials)},
            {"sigmoid", nameOf(fit.function.sigmoid)},
            {"design", designName(fit)},
            {"alternatives", fit.alternatives},
            {"falling", fit.function.falling},
            {"log_x", fit.function.log_axis},
            {"method", nameOf(fit.method)},
            {"free_parameters", fit.free_parameters},
            {"log_likelihood", fit.log_likelihood},
            {"log_evidence", fit.log_evidence},
            {"aic", fit.aic},
            {"bic", fit.bic}};
  if (fit.w) {
    json["w"] = fit.w->value;
    json["intervals"]["w"] = intervalJson(fit.w->interval);
  }
  for (const auto& [name, estimate] :
       {std::pair("threshold", &fit.threshold), std::pair("width", &fit.width), std::pair("jnd", &fit.jnd),
        std::pair("weber_fraction", &fit.weber_fraction), std::pair("lapse", &fit.lapse),
        std::pair("guess", &fit.guess), std::pair("overdispersion", &fit.overdispersion)}) {
    if (isAtEdge(*estimate)) {
      json["at_edge"].push_back(name);
    }
  }
  if (!fit.doubt.empty()) {
    json["doubt"] = fit.doubt;
  }
  for (const Level& level : fit.levels) {
    json["levels"].push_back({{"x", level.x}, {"k", std::llround(level.k)}, {"n", std::llround(level.n)}});
  }
  return json;
}

}  // namespace haptolith

#include "study/fit_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string_view>

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

Json intervalJson(const Interval& interval) {
  return Json::array({interval.low, interval.high});
}

std::string_view nameOf(FitMethod method) {
  switch (method) {
    case FitMethod::kMedian: return "median";
    case FitMethod::kMaximumLikelihood: return "ml";
    case FitMethod::kMap: break;
  }
  return "map";
}

std::string_view wordsFor(FitMethod method) {
  switch (method) {
    case FitMethod::kMedian: return "medians of the posterior";
    case FitMethod::kMaximumLikelihood: return "most likely";
    case FitMethod::kMap: break;
  }
  return "most probable";
}

std::string intervalText(const Interval& interval) {
  if (std::isnan(interval.low)) {
    return "";
  }
  return interval.low == interval.high ? "fixed" : fmt::format("{:.4g} to {:.4g}", interval.low, interval.high);
}

std::string line(std::string_view name, const Estimate& estimate, std::string_view note = "") {
  return fmt::format("  {:<16} {:>9.4g}   {:<22} {}\n", name, estimate.value, intervalText(estimate.interval), note);
}

std::string_view readingOf22(Sigmoid sigmoid) {
  switch (sigmoid) {
    case Sigmoid::kWeberAsPrinted: return "of (22) as printed";
    case Sigmoid::kWeberLog10: return "of (22) as printed, logarithms to base 10";
    default: return "of (22)";
  }
}

std::string designName(const Fit& fit) {
  return fit.design == Design::kForcedChoice ? fmt::format("{}afc", fit.alternatives) : std::string(nameOf(fit.design));
}

std::string_view scaleName(const Fit& fit) {
  return isWeber(fit.function.sigmoid) ? "Weber fraction" : "width";
}

}  // namespace

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
  for (const Level& level : fit.levels) {
    json["levels"].push_back({{"x", level.x}, {"k", std::llround(level.k)}, {"n", std::llround(level.n)}});
  }
  return json;
}

Json groupJson(const GroupFit& group, const std::vector<std::string>& names) {
  const auto population_json = [](const Population& population) {
    return Json{{"median", population.median.value},
                {"median_interval", intervalJson(population.median.interval)},
                {"spread", population.spread.value},
                {"spread_interval", intervalJson(population.spread.interval)}};
  };
  const char* scale = isWeber(group.pooled.function.sigmoid) ? "weber_fraction" : "width";
  Json json{{scale, population_json(group.scale)}};
  if (group.threshold) {
    json["threshold"] = population_json(*group.threshold);
  }
  for (std::size_t i = 0; i < group.participants.size(); ++i) {
    const Fit& fit = group.participants[i];
    json["participants"].push_back({{"participant", names[i]},
                                    {"n_trials", std::llround(fit.n_trials)},
                                    {"threshold", fit.threshold.value},
                                    {"weber_fraction", fit.weber_fraction.value},
                                    {"weber_fraction_interval", intervalJson(fit.weber_fraction.interval)},
                                    {"width", fit.width.value},
                                    {"width_interval", intervalJson(fit.width.interval)},
                                    {std::string(scale) + "_in_group", group.scale.participants[i].value}});
  }
  return json;
}

std::string fitText(const Fit& fit) {
  const PsychometricFunction& function = fit.function;
  const std::string_view interval =
      fit.method == FitMethod::kMaximumLikelihood ? "profile interval" : "credible interval";
  std::string text =
      fmt::format("Psychometric function {} ({}), {}; {} answers to {} stimuli\n\n", nameOf(function.sigmoid),
                  designName(fit), wordsFor(fit.method), fit.n_trials, fit.levels.size());
  text += fmt::format("{:>28}   {:g} % {}\n", "estimate", 100 * fit.confidence, interval);
  text += line("threshold", fit.threshold, "x50, where the sigmoid is a half");
  text += line("JND", fit.jnd, "x84 - x50");
  text += line("Weber fraction", fit.weber_fraction, "x84/x50 - 1");
  if (fit.w) {
    text += line("w", *fit.w, readingOf22(function.sigmoid));
  }
  text += line("width", fit.width, function.log_axis ? "ln(x95/x05)" : "x95 - x05");
  text += line("lapse rate", fit.lapse);
  text += line("guess rate", fit.guess);
  text += line("overdispersion", fit.overdispersion, "eta; 0 is binomial");
  text += fmt::format(
      "\n  deviance {:.4g}; a function like this gives worse fits in {:.3g} % of simulations "
      "({:.3g} % by chi-square)\n",
      fit.deviance, 100 * fit.p_value, 100 * fit.p_value_chi_square);
  return text;
}

std::string groupText(const GroupFit& group, const std::vector<std::string>& names) {
  const std::string_view scale = scaleName(group.pooled);
  std::string text = fmt::format("\n  {:<16} {:>9}   {:<22} {:>9}   within the group\n", "participant", scale,
                                 fmt::format("{:g} %", 100 * group.pooled.confidence), "threshold");
  for (std::size_t i = 0; i < group.participants.size(); ++i) {
    const Fit& fit = group.participants[i];
    const Estimate& own = isWeber(fit.function.sigmoid) ? fit.weber_fraction : fit.width;
    text += fmt::format("  {:<16} {:>9.4g}   {:<22} {:>9.4g}   {:.4g}\n", names[i], own.value,
                        intervalText(own.interval), fit.threshold.value, group.scale.participants[i].value);
  }
  text += "\n";
  text += line("median", group.scale.median, fmt::format("of people's {}", scale));
  text += line("spread", group.scale.spread, "between people, standard deviation of its logarithm");
  if (group.threshold) {
    text += line("median", group.threshold->median, "of people's threshold");
    text += line("spread", group.threshold->spread, "between people");
  }
  return text;
}

std::string comparisonText(const std::vector<Fit>& fits) {
  std::string text = fmt::format("\n  {:<12} {:>12} {:>10} {:>10} {:>10} {:>10}\n", "sigmoid", "log evidence", "AIC",
                                 "BIC", "threshold", "deviance");
  for (const Fit& fit : fits) {
    text += fmt::format("  {:<12} {:>12.3f} {:>10.2f} {:>10.2f} {:>10.4g} {:>10.3f}\n", nameOf(fit.function.sigmoid),
                        fit.log_evidence, fit.aic, fit.bic, fit.threshold.value, fit.deviance);
  }
  return text;
}

}  // namespace haptolith

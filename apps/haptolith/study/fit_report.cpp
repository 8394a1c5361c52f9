#include "study/fit_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "haptolith/core/pluralise.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

std::string_view wordsFor(FitMethod method) {
  switch (method) {
    case FitMethod::kMedian: return "medians of the posterior";
    case FitMethod::kMaximumLikelihood: return "most likely";
    case FitMethod::kMap: break;
  }
  return "most probable";
}

/// Rounds to 0 a value that is a rounding error, if the interval includes 0; small numbers of one sign are kept.
double rounded(double value, const Interval& interval) {
  constexpr double kRounding = 1e-12;
  const bool is_rounding =
      interval.low < 0 && std::abs(value) <= kRounding * std::max(-interval.low, std::abs(interval.high));
  return is_rounding ? 0 : value + 0.0;  // -0 is 0
}

std::string intervalText(const Interval& interval) {
  if (std::isnan(interval.low)) {
    return "";
  }
  return interval.low == interval.high
             ? "fixed"
             : fmt::format("{:.4g} to {:.4g}", rounded(interval.low, interval), rounded(interval.high, interval));
}

/// Formats an estimate. @param note  printed unless the estimate is unknown or outside its interval.
std::string line(std::string_view name, const Estimate& estimate, std::string_view note = "") {
  if (std::isnan(estimate.value)) {
    return fmt::format("  {:<16} {:>9}   {:<22} undefined if the threshold can be 0 or less\n", name, "-", "");
  }
  if (isAtEdge(estimate)) {
    note = "at the limit of its range; equal-tailed interval";
  }
  return fmt::format("  {:<16} {:>9.4g}   {:<22} {}\n", name, rounded(estimate.value, estimate.interval),
                     intervalText(estimate.interval), note);
}

/// Returns the goodness of fit, and doubts.
std::string judgementOf(const Fit& fit) {
  std::string text = fmt::format("\n  deviance {:.4g}", fit.deviance);
  const bool is_simulated = !std::isnan(fit.p_value);
  const bool is_compared = !std::isnan(fit.p_value_chi_square);
  if (is_simulated || is_compared) {
    text += "; a worse fit occurs in ";
  }
  if (is_simulated) {
    text += fmt::format("{:.3g} % of simulations", 100 * fit.p_value);
  }
  if (is_compared) {
    const std::string compared = fmt::format("{:.3g} % by chi-square", 100 * fit.p_value_chi_square);
    text += is_simulated ? " (" + compared + ")" : compared;
  }
  if (!is_simulated && !is_compared) {
    text += "; not compared with anything: no simulations, and no more stimuli than free parameters";
  }
  return text + "\n" + (fit.doubt.empty() ? "" : "  Doubtful: " + fit.doubt + "\n");
}

std::string_view readingOf22(Sigmoid sigmoid) {
  switch (sigmoid) {
    case Sigmoid::kWeberAsPrinted: return "as in (22), printed";
    case Sigmoid::kWeberLog10: return "as in (22), printed, logarithms to base 10";
    default: return "as in (22)";
  }
}

std::string_view scaleName(const Fit& fit) {
  return isWeber(fit.function.sigmoid) ? "Weber fraction" : "width";
}

}  // namespace

Json groupJson(const GroupFit& group, const std::vector<std::string>& names) {
  const auto population_json = [](const Population& population) {
    return Json{{"median", population.median.value},
                {"median_interval", intervalJson(population.median.interval)},
                {"spread", population.spread.value},
                {"spread_interval", intervalJson(population.spread.interval)},
                {"bayes_factor_alike", population.alike}};
  };
  const Fit& middle = group.median_person;
  const bool weber = isWeber(middle.function.sigmoid);
  const std::string scale = weber ? "weber_fraction" : "width";
  Json json{{scale, population_json(group.scale)}};
  if (group.threshold) {
    json["threshold"] = population_json(*group.threshold);
  }
  json["jnd"] = {{"median", middle.jnd.value}, {"median_interval", intervalJson(middle.jnd.interval)}};
  json["lapse"] = {{"median", middle.lapse.value}, {"median_interval", intervalJson(middle.lapse.interval)}};
  json["confidence"] = middle.confidence;
  json["n_trials"] = std::llround(middle.n_trials);
  for (std::size_t i = 0; i < group.participants.size(); ++i) {
    const Fit& within = group.participants[i];
    const Population& scales = group.scale;
    Json person{{"participant", names[i]},
                {"n_trials", std::llround(within.n_trials)},
                {scale + "_in_group", scales.participants[i].value},
                {scale + "_in_group_interval", intervalJson(scales.participants[i].interval)},
                {"threshold_in_group", within.threshold.value},
                {"threshold_in_group_interval", intervalJson(within.threshold.interval)},
                {"jnd_in_group", within.jnd.value},
                {"jnd_in_group_interval", intervalJson(within.jnd.interval)}};
    if (const std::optional<Fit>& alone = group.alone[i]) {
      person.update({{"threshold", alone->threshold.value},
                     {"weber_fraction", alone->weber_fraction.value},
                     {"weber_fraction_interval", intervalJson(alone->weber_fraction.interval)},
                     {"width", alone->width.value},
                     {"width_interval", intervalJson(alone->width.interval)}});
    }
    json["participants"].push_back(std::move(person));
  }
  return json;
}

std::string fitText(const Fit& fit) {
  const PsychometricFunction& function = fit.function;
  const std::string_view interval =
      fit.method == FitMethod::kMaximumLikelihood ? "profile interval" : "credible interval";
  std::string text = fmt::format("Psychometric function {} ({}), {}; {} responses to {}\n\n", nameOf(function.sigmoid),
                                 designName(fit), wordsFor(fit.method), fit.n_trials,
                                 pluralise(fit.levels.size(), "stimulus", "stimuli"));
  text += fmt::format("{:>28}   {:g} % {}\n", "estimate", 100 * fit.confidence, interval);
  text += line("threshold", fit.threshold, "x50, where the sigmoid is 0.5");
  text += line("JND", fit.jnd, "x84 - x50");
  text += line("Weber fraction", fit.weber_fraction, "x84/x50 - 1");
  if (fit.w) {
    text += line("w", *fit.w, readingOf22(function.sigmoid));
  }
  text += line("width", fit.width, function.log_axis ? "ln(x95/x05)" : "x95 - x05");
  text += line("lapse rate", fit.lapse);
  text += line("guess rate", fit.guess);
  text += line("overdispersion", fit.overdispersion, "eta; 0 is binomial");
  return text + judgementOf(fit);
}

std::string groupText(const GroupFit& group, const std::vector<std::string>& names) {
  const Fit& middle = group.median_person;
  const std::string_view scale = scaleName(middle);
  std::string text = fmt::format(
      "\nPopulation median, by a hierarchical model of {} participants; {} responses to {} stimuli\n\n{:>28}   {:g} % "
      "credible interval\n",
      names.size(), middle.n_trials, middle.levels.size(), "estimate", 100 * middle.confidence);
  text += line(scale, group.scale.median, "population median");
  if (middle.function.sigmoid == Sigmoid::kWeberAsPrinted) {
    text += line("w", *middle.w, "as in (22), printed");
  }
  text += line("PSE", middle.threshold, "population median of x50");
  text += line("JND", middle.jnd, "x84 - x50");
  text += line("lapse rate", middle.lapse, "shared by all participants");
  text += line("SD", group.scale.spread, fmt::format("standard deviation of ln({}) between participants", scale));
  if (group.threshold) {
    text += line("SD", group.threshold->spread,
                 middle.function.log_axis ? "standard deviation of ln(PSE) between participants"
                                          : "standard deviation of the PSE between participants");
  }
  text += fmt::format("\n  {:<16} {:>9} {:<22} {:>9} {:<22}  {} from separate fits\n", "participant", scale, "", "PSE",
                      "", scale);
  for (std::size_t i = 0; i < group.participants.size(); ++i) {
    const Fit& within = group.participants[i];
    const Estimate& own = group.scale.participants[i];
    std::string alone = "too few stimuli";
    if (const std::optional<Fit>& fit = group.alone[i]) {
      const Estimate& it = isWeber(fit->function.sigmoid) ? fit->weber_fraction : fit->width;
      alone = fmt::format("{:.4g}   {}", it.value, intervalText(it.interval));
    }
    text +=
        fmt::format("  {:<16} {:>9.4g}   {:<22} {:>9.4g}   {:<22} {}\n", names[i], own.value,
                    intervalText(own.interval), within.threshold.value, intervalText(within.threshold.interval), alone);
  }
  return text;
}

Json changesJson(const Change& scale, const std::optional<Change>& threshold) {
  const auto change_json = [](const Change& change) {
    return Json{{"ratio", std::exp(change.mean.value)},
                {"interval", {std::exp(change.mean.interval.low), std::exp(change.mean.interval.high)}},
                {"bayes_factor_same", change.same},
                {"prior_log_deviation", change.prior.usual}};
  };
  Json json{{"weber_fraction", change_json(scale)}};
  if (threshold) {
    json["pse_over_reference"] = change_json(*threshold);
  }
  return json;
}

std::string changesText(const std::string& heading, const Change& scale, const std::optional<Change>& threshold,
                        double confidence) {
  const auto line = [](std::string_view what, const Change& change) {
    return fmt::format(
        "  {:<16} {:>9.4g}   {:<22} Bayes factor of no difference {}, prior of its logarithm "
        "normal(0, {:.3g})\n",
        what, std::exp(change.mean.value),
        fmt::format("{:.4g} to {:.4g}", std::exp(change.mean.interval.low), std::exp(change.mean.interval.high)),
        bayesFactorText(change.same), change.prior.usual);
  };
  std::string told = fmt::format("{}\n\n{:>28}   {:g} % credible interval\n", heading, "ratio", 100 * confidence);
  told += line("Weber fraction", scale);
  if (threshold) {
    told += line("PSE / reference", *threshold);
  }
  return told;
}

std::string bayesFactorText(double factor) {
  constexpr double kLeast = 1e-6;  // resolution of the sums over grids
  return factor < kLeast ? fmt::format("below {:g}", kLeast) : fmt::format("{:.2g}", factor);
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

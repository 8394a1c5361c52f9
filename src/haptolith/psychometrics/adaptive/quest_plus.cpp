#include "haptolith/psychometrics/adaptive/quest_plus.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "haptolith/core/assert.h"
#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr int kThresholds = 15;
constexpr int kWidths = 25;

/// Returns -p ln p, 0 at 0.
double entropyTerm(double p) noexcept {
  return p > 0 ? -p * std::log(p) : 0;
}

std::vector<double> spaced(double low, double high, int count) {
  HAPTO_ASSERT(count > 0);
  HAPTO_ASSERT(low <= high);
  std::vector<double> values(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    values[i] = low + (high - low) * i / (count - 1);
  }
  return values;
}

/// Default values for the options that are not set.
struct QuestGrid {
  std::vector<double> thresholds = {};
  std::vector<double> widths = {};  // in units of the axis
};

QuestGrid gridOf(const QuestPlusOptions& options, const std::vector<double>& levels, double reference) {
  PsychometricFunction axis{.sigmoid = options.sigmoid,
                            .log_axis = options.log_axis || isAlwaysLogarithmic(options.sigmoid)};
  const double low = toAxis(axis, levels.front());
  const double range = toAxis(axis, levels.back()) - low;
  double least = range;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    least = std::min(least, toAxis(axis, levels[i]) - toAxis(axis, levels[i - 1]));
  }
  QuestGrid grid{.thresholds = options.thresholds};
  if (grid.thresholds.empty()) {
    const double middle = isWeber(options.sigmoid) ? toAxis(axis, reference) : low + range / 2;
    const double half = isWeber(options.sigmoid) ? range / 4 : range / 2;
    for (const double place : spaced(middle - half, middle + half, kThresholds)) {
      grid.thresholds.push_back(fromAxis(axis, place));
    }
  }
  for (const double width : options.widths) {
    grid.widths.push_back(isWeber(options.sigmoid) ? weberWidth(Sigmoid::kWeber, width) : width);
  }
  if (grid.widths.empty()) {
    for (const double log_width : spaced(std::log(least), std::log(3 * range), kWidths)) {
      grid.widths.push_back(std::exp(log_width));
    }
  }
  return grid;
}

/// Returns the guess rates for a lapse rate.
std::vector<double> guessesOf(const QuestPlusOptions& options, double lapse) {
  switch (options.design) {
    case Design::kForcedChoice: return {1.0 / options.alternatives};
    case Design::kEqualAsymptote: return {lapse};
    case Design::kYesNo: break;
  }
  return options.guesses;
}

void requireOptions(const QuestPlusOptions& options) {
  requireInRange("alternatives", options.alternatives, {2, 100});
  const auto require = [](std::string_view key, const std::vector<double>& rates) {
    if (rates.empty()) {
      throw InvalidParameter(std::string(key), "none", "one rate or more");
    }
    for (const double rate : rates) {
      requireInRange(key, rate, {0, 0.5});
    }
  };
  require("lapses", options.lapses);
  require("guesses", options.guesses);
}

/// Returns a quantile. The mass at each value (ascending) is distributed uniformly to the midpoints with its
/// neighbours, and symmetrically at the ends.
double quantile(const std::vector<std::pair<double, double>>& masses, double share) {
  HAPTO_ASSERT(share >= 0 && share <= 1);
  HAPTO_ASSERT(!masses.empty());
  double below = 0;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const auto& [value, mass] = masses[i];
    if (below + mass < share && i + 1 < masses.size()) {
      below += mass;
      continue;
    }
    const double to_next = i + 1 < masses.size() ? (masses[i + 1].first - value) / 2 : 0;
    const double to_last = i > 0 ? (value - masses[i - 1].first) / 2 : to_next;
    const double high = value + (i + 1 < masses.size() ? to_next : to_last);
    const double low = value - to_last;
    return mass > 0 ? low + (high - low) * std::clamp((share - below) / mass, 0.0, 1.0) : value;
  }
  return 0;
}

/// Returns median and interval of `place` over the hypotheses.
template <class Place>
Estimate marginal(const std::vector<Hypothesis>& hypotheses, double confidence, Place place) {
  HAPTO_ASSERT(!hypotheses.empty());
  requireInRange("confidence", confidence, {0, 1, Ends::kOpen});
  std::map<double, double> sums;
  for (const auto& [function, probability] : hypotheses) {
    sums[place(function)] += probability;
  }
  const std::vector<std::pair<double, double>> masses(sums.begin(), sums.end());
  const double tail = (1 - confidence) / 2;
  return {.value = quantile(masses, 0.5), .interval = {quantile(masses, tail), quantile(masses, 1 - tail)}};
}

template <class Function>
Estimate mapped(const Estimate& estimate, Function function) {
  return {.value = function(estimate.value),
          .interval = {function(estimate.interval.low), function(estimate.interval.high)}};
}

}  // namespace

QuestPlus::QuestPlus(std::vector<double> levels, std::vector<Hypothesis> hypotheses, int trials, double enough_spread)
    : levels_(std::move(levels)), hypotheses_(std::move(hypotheses)), trials_(trials), enough_spread_(enough_spread) {
  requireInRange("levels of QUEST+", double(levels_.size()), {.lowest = 1});
  requireInRange("hypotheses of QUEST+", double(hypotheses_.size()), {.lowest = 1});
  requireInRange("trials of QUEST+", trials, {.lowest = 1});
  requireInRange("enough_spread", enough_spread, {.lowest = 0});
  for (const double level : levels_) {
    std::vector<double>& row = positive_.emplace_back();
    for (const Hypothesis& hypothesis : hypotheses_) {
      row.push_back(haptolith::probability(hypothesis.function, level));
    }
  }
}

double QuestPlus::expectedEntropy(std::size_t level) const {
  // With joint probabilities j = p(response, hypothesis) and their sum s, s times the entropy of j/s is sum(-j ln j) +
  // s ln s.
  double positive = 0;
  double entropy = 0;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    const double joint = hypotheses_[i].probability * positive_[level][i];
    positive += joint;
    entropy += entropyTerm(joint) + entropyTerm(hypotheses_[i].probability - joint);
  }
  return entropy - entropyTerm(positive) - entropyTerm(1 - positive);
}

std::optional<double> QuestPlus::next() const {
  if (answered_ >= trials_ || (enough_spread_ > 0 && answered_ > 0 && logWidthSpread() < enough_spread_)) {
    return std::nullopt;
  }
  std::size_t best = 0;
  double least = expectedEntropy(0);
  for (std::size_t i = 1; i < levels_.size(); ++i) {
    const double entropy = expectedEntropy(i);
    if (entropy < least) {
      best = i;
      least = entropy;
    }
  }
  return levels_[best];
}

void QuestPlus::answer(double x, bool positive) {
  const auto found = std::ranges::find(levels_, x);
  if (found == levels_.end()) {
    throw InvalidParameter("level of a response", fmt::format("{}", x), "a level of QUEST+");
  }
  const std::vector<double>& row = positive_[static_cast<std::size_t>(found - levels_.begin())];
  double sum = 0;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    hypotheses_[i].probability *= positive ? row[i] : 1 - row[i];
    sum += hypotheses_[i].probability;
  }
  if (sum <= 0) {
    throw InvalidParameter("answer", fmt::format("{} to {}", positive ? "positive" : "negative", x),
                           "a response that one of the hypotheses allows; give QUEST+ a lapse rate above 0");
  }
  for (Hypothesis& hypothesis : hypotheses_) {
    hypothesis.probability /= sum;
  }
  ++answered_;
}

double QuestPlus::logWidthSpread() const {
  double mean = 0;
  double square = 0;
  for (const Hypothesis& hypothesis : hypotheses_) {
    const double place = std::log(hypothesis.function.width);
    mean += hypothesis.probability * place;
    square += hypothesis.probability * place * place;
  }
  return std::sqrt(std::max(square - mean * mean, 0.0));
}

std::optional<AdaptiveEstimate> QuestPlus::estimate() const {
  if (answered_ == 0) {
    return std::nullopt;
  }
  PsychometricFunction middle = hypotheses_.front().function;
  middle.threshold = threshold().value;
  middle.width = width().value;
  return AdaptiveEstimate{middle.threshold, jndOf(middle)};
}

Estimate QuestPlus::threshold(double confidence) const {
  const PsychometricFunction& any = hypotheses_.front().function;  // any one, because all have the same axis
  const auto place = [](const PsychometricFunction& function) { return toAxis(function, function.threshold); };
  return mapped(marginal(hypotheses_, confidence, place), [&any](double at) { return fromAxis(any, at); });
}

Estimate QuestPlus::width(double confidence) const {
  const auto place = [](const PsychometricFunction& function) { return std::log(function.width); };
  return mapped(marginal(hypotheses_, confidence, place), [](double at) { return std::exp(at); });
}

std::unique_ptr<QuestPlus> makeQuestPlus(const QuestPlusOptions& options, std::vector<double> levels,
                                         double reference) {
  const bool log_axis = options.log_axis || isAlwaysLogarithmic(options.sigmoid);
  const Range on_axis = log_axis ? Range{.lowest = 0, .ends = Ends::kOpen} : Range{};
  for (const double level : levels) {
    requireInRange("level", level, on_axis);
  }
  requireInRange("reference", reference, on_axis);
  if (levels.size() < 2 || std::ranges::adjacent_find(levels, std::ranges::greater_equal{}) != levels.end()) {
    throw InvalidParameter("levels", fmt::format("{} of them", levels.size()), "two or more in ascending order");
  }
  requireOptions(options);
  const QuestGrid grid = gridOf(options, levels, reference);
  std::vector<Hypothesis> hypotheses;
  for (const double threshold : grid.thresholds) {
    requireInRange("threshold", threshold, on_axis);
    for (const double width : grid.widths) {
      requireInRange("width", width, {.lowest = 0, .ends = Ends::kOpen});
      for (const double lapse : options.lapses) {
        for (const double guess : guessesOf(options, lapse)) {
          hypotheses.push_back({{.sigmoid = options.sigmoid,
                                 .log_axis = log_axis,
                                 .threshold = threshold,
                                 .width = width,
                                 .guess = guess,
                                 .lapse = lapse}});
        }
      }
    }
  }
  for (Hypothesis& hypothesis : hypotheses) {
    hypothesis.probability = 1.0 / double(hypotheses.size());
  }
  return std::make_unique<QuestPlus>(std::move(levels), std::move(hypotheses), options.trials, options.enough_spread);
}

}  // namespace haptolith

#include "haptolith/study/ideal_observer.h"

#include <boost/math/distributions/normal.hpp>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/model.h"

namespace haptolith {

namespace {

/// Force at a moving hand: 0.08 to 0.13 by joint, and 0.04 N, the least that is noticed (Feyzabadi et al. 2013).
constexpr Sense kForce{.weber_fraction = 0.11, .threshold = 0.04};
/// Resistance to motion: viscosity's Weber fraction (Jones, Hunter and Lafontaine 1997).
constexpr Sense kResistance{.weber_fraction = 0.19, .threshold = 0.04};
/// Weight that a device shows at rest: 0.22 to 0.44 (van Beek et al. 2021).
constexpr Sense kWeight{.weber_fraction = 0.33, .threshold = 0.04};

constexpr std::array kCues{
    Cue{"mean force", "N", "mean force", kForce, [](const Exploration& e) { return e.felt.mean_force_n; }},
    Cue{"peak force", "N", "greatest force", kForce, [](const Exploration& e) { return e.felt.peak_force_n; }},
    Cue{"force sd", "N", "standard deviation of force", kForce, [](const Exploration& e) { return e.felt.force_sd_n; }},
    Cue{"drag", "N", "work over path", kResistance, [](const Exploration& e) { return e.drag_n; }},
    Cue{"weight", "N", "downward force while lifting", kWeight, [](const Exploration& e) { return e.carried_n; }},
};

struct Moments {
  double mean = 0, variance = 0;
};

Moments sensations(std::span<const double> magnitudes, const Sense& sense) {
  const auto count = static_cast<double>(magnitudes.size());
  if (magnitudes.size() < 2) {
    throw InvalidParameter("magnitudes of a stimulus", fmt::format("{}", magnitudes.size()), "2 or more");
  }
  Moments moments;
  for (const double magnitude : magnitudes) {
    moments.mean += sensation(magnitude, sense) / count;
  }
  for (const double magnitude : magnitudes) {
    const double off = sensation(magnitude, sense) - moments.mean;
    moments.variance += off * off / (count - 1);
  }
  return moments;
}

/// The Weber fraction of (paper 22) for the shares Phi(d) of answers, and the most that the fit allows.
void fitWeber(std::span<const FeltStimulus> stimuli, std::size_t reference, Discrimination& found) {
  constexpr double kAnswers = 1000;  // whole numbers of answers near enough to the shares
  std::vector<Level> levels;
  for (std::size_t i = 0; i < stimuli.size(); ++i) {
    if (i != reference) {
      const double share = boost::math::cdf(boost::math::normal(), found.jnds[i]);
      levels.push_back({.x = stimuli[i].x, .k = std::round(kAnswers * share), .n = kAnswers});
    }
  }
  FitOptions options = weberOptions(stimuli[reference].x);
  options.lapse = 0;
  options.overdispersion = 0;
  options.simulations = 0;
  const Model model(levels, options);
  found.most = model.support(kScale).high;
  found.weber_fraction = fitPsychometric(levels, options).weber_fraction.value;
  constexpr double kAtTheEnd = 0.95;
  if (found.weber_fraction > kAtTheEnd * found.most) {
    found.weber_fraction = std::numeric_limits<double>::infinity();
  }
}

}  // namespace

std::span<const Cue> cues() {
  return kCues;
}

double sensation(double magnitude, const Sense& sense) noexcept {
  const double k = std::log1p(sense.weber_fraction);
  return std::asinh(k * magnitude / sense.threshold) / k;
}

double discriminability(std::span<const double> a, std::span<const double> b, const Sense& sense) {
  const Moments of_a = sensations(a, sense);
  const Moments of_b = sensations(b, sense);
  return (of_b.mean - of_a.mean) / std::sqrt(1 + of_a.variance + of_b.variance);
}

Discrimination discriminate(std::span<const FeltStimulus> stimuli, std::size_t reference, const Sense& sense) {
  if (stimuli.size() < 3 || reference >= stimuli.size()) {
    throw InvalidParameter("stimuli", fmt::format("{}, with reference {}", stimuli.size(), reference),
                           "3 or more, one of them the reference");
  }
  Discrimination found;
  double trend = 0;
  for (std::size_t i = 0; i < stimuli.size(); ++i) {
    const auto against = [&](std::size_t other) {
      return discriminability(stimuli[other].magnitudes, stimuli[i].magnitudes, sense);
    };
    found.jnds.push_back(i == reference ? 0 : against(reference));
    if (i > 0) {
      found.steps.push_back(against(i - 1));
    }
    trend += found.jnds.back() * std::log(stimuli[i].x / stimuli[reference].x);
  }
  found.rises = trend >= 0;
  if (!found.rises) {
    for (double& jnd : found.jnds) {
      jnd = -jnd;
    }
    for (double& step : found.steps) {
      step = -step;
    }
  }
  fitWeber(stimuli, reference, found);
  return found;
}

}  // namespace haptolith

#include "haptolith/study/perception/ideal_observer.h"

#include <Eigen/Dense>
#include <boost/math/distributions/normal.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/model.h"

namespace haptolith {

namespace {

/// Force on a moving hand: Weber fraction 0.08 to 0.13 depending on the joint; detection threshold 0.04 N (Feyzabadi
/// et al. 2013).
constexpr Sense kForce{.weber_fraction = 0.11, .threshold = 0.04};
/// Resistance to motion: Weber fraction of viscosity (Jones, Hunter and Lafontaine 1997).
constexpr Sense kResistance{.weber_fraction = 0.19, .threshold = 0.04};
/// Weight that a device renders at rest: Weber fraction 0.22 to 0.44 (van Beek et al. 2021).
constexpr Sense kWeight{.weber_fraction = 0.33, .threshold = 0.04};

constexpr std::array kCues{
    Cue{"mean force", "N", "mean force", kForce, [](const Exploration& e) { return e.summary.mean_force_n; }},
    Cue{"peak force", "N", "greatest force", kForce, [](const Exploration& e) { return e.summary.peak_force_n; }},
    Cue{"force sd", "N", "standard deviation of force", kForce,
        [](const Exploration& e) { return e.summary.force_sd_n; }},
    Cue{"drag", "N", "work over path", kResistance, [](const Exploration& e) { return e.drag_n; }},
    Cue{"weight", "N", "downward force while lifting", kWeight, [](const Exploration& e) { return e.carried_n; }},
};

constexpr double kPerMm = 1e3;

/// Position of the hand, in mm: Weber fraction 0.09 of a limb's displacement (Jones and Hunter 1992). An arm's angles
/// are sensed to 0.6 to 1.1 degrees (van Beers et al. 1998), which is 6 mm at 0.45 m from the shoulder.
constexpr Sense kPlace{.weber_fraction = 0.09, .threshold = 6};
constexpr std::array kPlaceCues{
    Cue{"felt up to", "mm", "height of rendered soil", kPlace,
        [](const Exploration& e) { return kPerMm * e.touched_up_to_m; }},
};

/// Seen length, in mm: Weber fraction 0.04 of a height of 55 mm at 84 % correct (Ernst and Banks 2002). The threshold
/// is the eye's resolution of one minute of arc at 0.6 m.
constexpr Sense kLength{.weber_fraction = 0.04, .threshold = 0.17};

constexpr std::array kSeenCues{
    SeenCue{"height", "mm", "height of the surface", kLength, [](const Picture& p) { return kPerMm * p.height_m; }},
    SeenCue{"heave", "mm", "largest rise", kLength, [](const Picture& p) { return kPerMm * p.heave_m; }},
    SeenCue{"hollow", "mm", "largest fall", kLength, [](const Picture& p) { return kPerMm * p.hollow_m; }},
    SeenCue{"way", "mm", "displacement of surface particles", kLength,
            [](const Picture& p) { return kPerMm * p.moved_m; }},
    SeenCue{"reach", "mm", "depth of the tool", kLength, [](const Picture& p) { return kPerMm * p.reached_m; }, true},
    SeenCue{"load", "mm", "edge of a cube of the carried volume", kLength,
            [](const Picture& p) { return kPerMm * p.load_m; }},
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

/// Moments of several cues together.
struct JointMoments {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

JointMoments sensations(const SensedStimulus& stimulus, std::span<const Sense> senses) {
  const auto count = static_cast<Eigen::Index>(stimulus.magnitudes.size());
  const auto cues = static_cast<Eigen::Index>(senses.size());
  Eigen::MatrixXd sensed(count, cues);
  for (Eigen::Index row = 0; row < count; ++row) {
    for (Eigen::Index cue = 0; cue < cues; ++cue) {
      sensed(row, cue) = sensation(stimulus.magnitudes[static_cast<std::size_t>(row)][static_cast<std::size_t>(cue)],
                                   senses[static_cast<std::size_t>(cue)]);
    }
  }
  JointMoments moments{.mean = sensed.colwise().mean().transpose(), .covariance = {}};
  sensed.rowwise() -= moments.mean.transpose();
  moments.covariance = sensed.transpose() * sensed / static_cast<double>(count - 1);
  return moments;
}

void requireMagnitudes(const SensedStimulus& stimulus, std::size_t senses) {
  for (const std::vector<double>& exploration : stimulus.magnitudes) {
    if (exploration.size() != senses) {
      throw InvalidParameter("magnitudes of an exploration", fmt::format("{}", exploration.size()),
                             fmt::format("{}, as many as senses", senses));
    }
  }
}

void validate(std::span<const SensedStimulus> stimuli, std::size_t reference, std::span<const Sense> senses) {
  if (stimuli.size() < 3 || reference >= stimuli.size()) {
    throw InvalidParameter("stimuli", fmt::format("{}, with reference {}", stimuli.size(), reference),
                           "3 or more, one of them the reference");
  }
  requireInRange("number of senses", static_cast<double>(senses.size()), {1, 100});
  for (const SensedStimulus& stimulus : stimuli) {
    requireInRange("explorations of a stimulus", static_cast<double>(stimulus.magnitudes.size()), {2, 1e6});
    requireMagnitudes(stimulus, senses.size());
  }
}

/// Returns the distance from `a` to `b` in JNDs, for a judgement with these weights of the cues.
double apart(const JointMoments& a, const JointMoments& b, const Eigen::VectorXd& weights) {
  const double noise = weights.squaredNorm() + weights.dot((a.covariance + b.covariance) * weights);
  return weights.dot(b.mean - a.mean) / std::sqrt(noise);
}

/// Returns the optimum weights for deciding on which side of the reference a stimulus is.
Eigen::VectorXd learntWeights(std::span<const SensedStimulus> stimuli, std::size_t reference,
                              std::span<const JointMoments> sensed) {
  const auto cues = sensed[reference].mean.size();
  Eigen::VectorXd trend = Eigen::VectorXd::Zero(cues);
  Eigen::MatrixXd noise = Eigen::MatrixXd::Identity(cues, cues);
  for (std::size_t i = 0; i < stimuli.size(); ++i) {
    trend += std::log(stimuli[i].x / stimuli[reference].x) * (sensed[i].mean - sensed[reference].mean);
    noise += 2.0 / static_cast<double>(stimuli.size()) * sensed[i].covariance;
  }
  const Eigen::VectorXd weights = noise.ldlt().solve(trend);
  return weights.norm() > 0 ? Eigen::VectorXd(weights.normalized()) : Eigen::VectorXd::Ones(cues).normalized();
}

/// Fits the Weber fraction of eq. (22) in icra2021 to the fractions Phi(d) of responses; also sets the fit's upper
/// limit.
void fitWeber(std::span<const SensedStimulus> stimuli, std::size_t reference, Discrimination& found) {
  constexpr double kAnswers = 1000;  // enough for counts of responses to represent the fractions
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

Discrimination judged(std::span<const SensedStimulus> stimuli, std::size_t reference, std::span<const Sense> senses) {
  std::vector<JointMoments> sensed;
  sensed.reserve(stimuli.size());
  for (const SensedStimulus& stimulus : stimuli) {
    sensed.push_back(sensations(stimulus, senses));
  }
  const Eigen::VectorXd weights = learntWeights(stimuli, reference, sensed);
  Discrimination found;
  found.weights.assign(weights.begin(), weights.end());
  for (std::size_t i = 0; i < stimuli.size(); ++i) {
    found.jnds.push_back(i == reference ? 0 : apart(sensed[reference], sensed[i], weights));
    if (i > 0) {
      found.steps.push_back(apart(sensed[i - 1], sensed[i], weights));
    }
  }
  fitWeber(stimuli, reference, found);
  return found;
}

/// Returns every second exploration, beginning with the first or the second.
SensedStimulus half(const SensedStimulus& whole, std::size_t first) {
  SensedStimulus part{.x = whole.x};
  for (std::size_t i = first; i < whole.magnitudes.size(); i += 2) {
    part.magnitudes.push_back(whole.magnitudes[i]);
  }
  return part;
}

/// Returns JNDs with weights learnt from one half of the explorations and applied to the other.
double learntAndJudged(const std::array<JointMoments, 2>& learnt, const std::array<JointMoments, 2>& judged) {
  const Eigen::ArrayXd noise = 1 + learnt[0].covariance.diagonal().array() + learnt[1].covariance.diagonal().array();
  const Eigen::VectorXd weights = ((learnt[1].mean - learnt[0].mean).array() / noise).matrix();
  return weights.norm() > 0 ? apart(judged[0], judged[1], weights) : 0;
}

/// @param halves  halves of the reference, then of the test.
double judgedPair(const std::array<std::vector<SensedStimulus>, 2>& halves, std::span<const Sense> senses) {
  std::array<std::array<JointMoments, 2>, 2> moments;
  for (std::size_t part = 0; part < 2; ++part) {
    for (std::size_t stimulus = 0; stimulus < 2; ++stimulus) {
      moments[part][stimulus] = sensations(halves[stimulus][part], senses);
    }
  }
  return (learntAndJudged(moments[0], moments[1]) + learntAndJudged(moments[1], moments[0])) / 2;
}

/// Draws a bootstrap sample: for each stimulus its number of explorations, with replacement.
std::vector<SensedStimulus> resampled(std::span<const SensedStimulus> stimuli, std::mt19937_64& random) {
  std::vector<SensedStimulus> drawn(stimuli.begin(), stimuli.end());
  for (std::size_t i = 0; i < stimuli.size(); ++i) {
    const std::vector<std::vector<double>>& from = stimuli[i].magnitudes;
    for (std::vector<double>& exploration : drawn[i].magnitudes) {
      exploration = from[random() % from.size()];
    }
  }
  return drawn;
}

/// Returns percentiles of the results over the resamplings.
template <class Find>
Interval percentilesOf(const ObserverOptions& options, Find find) {
  std::vector<double> found(static_cast<std::size_t>(options.resamplings));
  std::ranges::generate(found, find);
  std::ranges::sort(found);
  const auto percentile = [&found](double share) {
    return found[static_cast<std::size_t>(std::lround(share * static_cast<double>(found.size() - 1)))];
  };
  return {.low = percentile((1 - options.confidence) / 2), .high = percentile((1 + options.confidence) / 2)};
}

}  // namespace

std::span<const Cue> cues() {
  return kCues;
}

std::span<const Cue> placeCues() {
  return kPlaceCues;
}

std::span<const SeenCue> seenCues() {
  return kSeenCues;
}

double dPrime(double jnds) noexcept {
  return std::numbers::sqrt2 * jnds;
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

PairDiscrimination discriminatePair(const SensedStimulus& reference, const SensedStimulus& test,
                                    std::span<const Sense> senses, const ObserverOptions& options) {
  std::array<std::vector<SensedStimulus>, 2> halves;
  for (std::size_t i = 0; i < 2; ++i) {
    const SensedStimulus& whole = i == 0 ? reference : test;
    requireInRange("explorations of a stimulus", static_cast<double>(whole.magnitudes.size()), {4, 1e6});
    requireMagnitudes(whole, senses.size());
    halves[i] = {half(whole, 0), half(whole, 1)};
  }
  PairDiscrimination found{.jnds = judgedPair(halves, senses)};
  if (options.resamplings > 0) {
    std::mt19937_64 random(options.seed);
    found.interval = percentilesOf(options, [&] {
      return judgedPair({resampled(halves[0], random), resampled(halves[1], random)}, senses);
    });
  }
  return found;
}

Discrimination discriminate(std::span<const SensedStimulus> stimuli, std::size_t reference,
                            std::span<const Sense> senses, const ObserverOptions& options) {
  validate(stimuli, reference, senses);
  Discrimination found = judged(stimuli, reference, senses);
  if (options.resamplings > 0) {
    std::mt19937_64 random(options.seed);
    found.interval =
        percentilesOf(options, [&] { return judged(resampled(stimuli, random), reference, senses).weber_fraction; });
  }
  return found;
}

}  // namespace haptolith

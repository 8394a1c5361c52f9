// Bias of the estimated Weber fraction and coverage of the interval: fits of simulated studies with the design of
// icra2021. docs/reports/psychometric-coverage.md has the table that this prints.
//
//     coverage [studies]        default: 1000
//     coverage [studies] ml    maximum-likelihood intervals, with free overdispersion and lapse rate

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string_view>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/goodness_of_fit.h"

#include "icra2021_experiments.h"

namespace {

using namespace haptolith;

/// Parameters of participants and fit.
struct Case {
  std::string_view name;
  double answers;  // to each level
  double lapse;
  bool free_lapse;
  bool free_threshold;
};
constexpr std::array<Case, 6> kCases{{{"w alone", 24, 0, false, false},
                                      {"w and PSE", 24, 0, false, true},
                                      {"w and lapse, which is 0", 24, 0, true, false},
                                      {"w and lapse, which is 0.02", 24, 0.02, true, false},
                                      {"w alone, but lapse is 0.02", 24, 0.02, false, false},
                                      {"w alone, 1 participant", 3, 0, false, false}}};

FitOptions optionsOf(const Experiment& experiment, const Case& of) {
  FitOptions options = weberOptions(experiment.reference);
  options.simulations = 0;
  if (of.free_lapse) {
    options.lapse.reset();
  }
  if (of.free_threshold) {
    options.threshold.reset();
  }
  return options;
}

void tell(const Experiment& experiment, const Case& of, int studies) {
  PsychometricFunction truth = weberFunction(experiment.reference, experiment.w);
  truth.lapse = truth.guess = of.lapse;
  std::vector<Level> levels;
  for (const double x : experiment.levels) {
    levels.push_back({x, 0, of.answers});
  }
  std::mt19937_64 random(1);
  std::vector<double> found;
  double sum = 0;
  int above = 0;
  int below = 0;
  for (int i = 0; i < studies; ++i) {
    const Fit fit = fitPsychometric(simulatedAnswers(levels, truth, random), optionsOf(experiment, of));
    found.push_back(fit.w->value);
    sum += fit.w->value;
    above += fit.w->interval.low > experiment.w ? 1 : 0;
    below += fit.w->interval.high < experiment.w ? 1 : 0;
  }
  std::ranges::sort(found);
  const auto share = [&](double of_all) { return found[static_cast<std::size_t>(of_all * (studies - 1))]; };
  fmt::print("{:<9} {:<27} {:>6.2f} {:>7.3f} {:>+6.1f} % {:>7.3f} {:>7.3f} {:>7.3f} {:>8.1f} % {:>6.1f} % {:>6.1f} %\n",
             experiment.name, of.name, experiment.w, sum / studies, 100 * (sum / studies / experiment.w - 1),
             share(0.5), share(0.16), share(0.84), 100 - 100.0 * (above + below) / studies, 100.0 * above / studies,
             100.0 * below / studies);
}

/// Parameters of responses that are fitted by maximum likelihood.
struct LikelihoodCase {
  std::string_view name;
  int levels;
  double answers;  // to each level
  PsychometricFunction truth;
  double eta;
  FitOptions options;
};

std::vector<LikelihoodCase> likelihoodCases() {
  const PsychometricFunction sure{.threshold = 1, .width = 1};
  const PsychometricFunction yes_no{.threshold = 1, .width = 1, .guess = 0.02, .lapse = 0.02};
  const PsychometricFunction choice{.threshold = 1, .width = 1, .guess = 0.5, .lapse = 0.05};
  const FitOptions no_rates{.lapse = 0, .guess = 0, .simulations = 0};
  const FitOptions free{.simulations = 0};
  const FitOptions two_alternatives{.design = Design::kForcedChoice, .simulations = 0};
  return {{"eta 0.3, no rates", 8, 40, sure, 0.3, no_rates},
          {"eta 0, no rates", 8, 40, sure, 0, no_rates},
          {"eta 0.3, yes/no", 8, 40, yes_no, 0.3, free},
          {"eta 0, yes/no", 8, 40, yes_no, 0, free},
          {"eta 0.2, 2AFC", 10, 40, choice, 0.2, two_alternatives},
          {"eta 0, 2AFC", 10, 40, choice, 0, two_alternatives},
          {"eta 0, 2AFC", 10, 10, choice, 0, two_alternatives}};
}

void tell(const LikelihoodCase& of, int studies) {
  std::vector<Level> levels;
  for (int i = 0; i < of.levels; ++i) {
    levels.push_back({0.25 + 1.5 * i / (of.levels - 1), 0, of.answers});
  }
  std::mt19937_64 random(1);
  std::array<double, 5> covered{};
  std::array<std::vector<double>, 5> lengths;
  for (int i = 0; i < studies; ++i) {
    const Fit fit = fitMaximumLikelihood(simulatedAnswers(levels, of.truth, random, of.eta), of.options);
    const std::array<Interval, 5> intervals{fit.threshold.interval, fit.width.interval, fit.lapse.interval,
                                            fit.guess.interval, fit.overdispersion.interval};
    const std::array<double, 5> truth{of.truth.threshold, of.truth.width, of.truth.lapse, of.truth.guess, of.eta};
    for (std::size_t j = 0; j < truth.size(); ++j) {
      constexpr double kRounding = 1e-6;
      const bool holds = intervals[j].low <= truth[j] + kRounding && truth[j] <= intervals[j].high + kRounding;
      covered[j] += holds ? 100.0 / studies : 0;
      lengths[j].push_back(intervals[j].high - intervals[j].low);
    }
  }
  fmt::print("{:<20} {:>2} x {:<3}", of.name, of.levels, of.answers);
  for (std::size_t j = 0; j < covered.size(); ++j) {
    std::ranges::sort(lengths[j]);
    fmt::print("  {:>5.1f} % ({:.3f})", covered[j], lengths[j][lengths[j].size() / 2]);
  }
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int studies = argc > 1 ? std::max(1, std::atoi(argv[1])) : 1000;
  if (argc > 2) {
    fmt::print(
        "{} simulated studies of each kind; coverage of 95 % intervals of the likelihood's profile, and their "
        "median length\n\n{:<28}{:>18}{:>18}{:>18}{:>18}{:>18}\n",
        studies, "fitted", "threshold", "width", "lapse", "guess", "eta");
    for (const LikelihoodCase& of : likelihoodCases()) {
      tell(of, studies);
    }
    return 0;
  }
  fmt::print("{} simulated studies of each kind; 95 % credible intervals\n\n", studies);
  fmt::print(
      "experiment fitted                        w    mean     bias  median     16 %    84 %   covered    above   "
      "below\n");
  for (const Experiment& experiment : kExperiments) {
    for (const Case& of : kCases) {
      tell(experiment, of, studies);
    }
  }
}

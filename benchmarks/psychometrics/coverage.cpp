// Simulated studies of the paper's design, fitted: is the Weber fraction found again, and does the interval hold what
// it says? docs/psychometrics.md has the table this prints.
//
//     coverage [studies]        1000 without a number

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>
#include <string_view>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/goodness_of_fit.h"

namespace {

using namespace haptolith;

/// One of the paper's two experiments (section III).
struct Experiment {
  std::string_view name;
  double reference;
  double w;
  std::array<double, 5> levels;
};
constexpr std::array<Experiment, 2> kExperiments{{{"friction", 0.835, 0.29, {0.600, 0.648, 0.735, 1.00, 1.21}},
                                                  {"gravity", 1.625, 3.31, {0.270, 0.625, 1.314, 3.721, 9.807}}}};

/// How participants are, and what is fitted.
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

}  // namespace

int main(int argc, char** argv) {
  const int studies = argc > 1 ? std::max(1, std::atoi(argv[1])) : 1000;
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

// Bias of the median participant's Weber fraction and coverage of its interval: fits of simulated groups by the
// hierarchical model. docs/reports/psychometric-coverage.md has the table that this prints.
//
//     haptolith_group_coverage [studies] [answers,answers] [experiment] [people]        400 3,10 both 8

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/goodness_of_fit.h"
#include "haptolith/psychometrics/group/group.h"

#include "icra2021_experiments.h"

namespace {

using namespace haptolith;

/// Parameters of participants.
struct Case {
  std::string_view name;
  double spread = 0;      // SD of ln w between participants
  double bias = 0;        // relative excess of the perceived test
  double blind = 0;       // lapse rate: fraction of random responses
  double pse_spread = 0;  // SD of ln(PSE) between participants, in units of ln(1 + w)
};
constexpr std::array<Case, 8> kCases{{{.name = "people alike"},
                                      {.name = "ln w differs by 0.3", .spread = 0.3},
                                      {.name = "ln w differs by 0.6", .spread = 0.6},
                                      {.name = "tests felt 10 % more", .bias = 0.1},
                                      {.name = "tests felt 20 % more", .bias = 0.2},
                                      {.name = "2 % blind answers", .blind = 0.02},
                                      {.name = "5 % blind answers", .blind = 0.05},
                                      {.name = "PSEs differ by half a JND", .pse_spread = 0.5}}};

std::vector<std::vector<Level>> groupOf(const Experiment& experiment, const Case& of, int count, double answers,
                                        std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Level> levels;
  for (const double x : experiment.levels) {
    levels.push_back({x, 0, answers});
  }
  std::vector<std::vector<Level>> people;
  for (int i = 0; i < count; ++i) {
    const double w = experiment.w * std::exp(of.spread * normal(random));
    const double pse =
        experiment.reference / (1 + of.bias) * std::pow(1 + experiment.w, of.pse_spread * normal(random));
    PsychometricFunction truth = weberFunction(pse, w);
    truth.lapse = truth.guess = of.blind / 2;
    people.push_back(simulatedAnswers(levels, truth, random));
  }
  return people;
}

bool holds(const Interval& interval, double value) {
  return interval.low <= value && value <= interval.high;
}

void tell(const Experiment& experiment, const Case& of, int count, double answers, int studies) {
  FitOptions options = weberOptions(experiment.reference);
  options.threshold.reset();
  options.lapse.reset();
  std::mt19937_64 random(1);
  std::vector<double> found;
  double mean = 0, ratio = 0, spread = 0;
  int covered = 0, pse_covered = 0, spread_covered = 0;
  for (int i = 0; i < studies; ++i) {
    const GroupFit group = fitGroup(groupOf(experiment, of, count, answers, random), options, Effort::kQuick);
    const Estimate& w = group.scale.median;
    found.push_back(w.value);
    mean += w.value / studies;
    ratio += std::log(w.interval.high / w.interval.low) / studies;
    spread += group.scale.spread.value / studies;
    covered += holds(w.interval, experiment.w) ? 1 : 0;
    pse_covered += holds(group.threshold->median.interval, experiment.reference / (1 + of.bias)) ? 1 : 0;
    spread_covered += holds(group.scale.spread.interval, of.spread) ? 1 : 0;
  }
  std::ranges::sort(found);
  const double median = found[found.size() / 2];
  const auto bias = [&](double value) { return 100 * (value / experiment.w - 1); };
  fmt::print(
      "{:<9} {:>3.0f}  {:<26} {:>7.3f} {:>+6.1f} % {:>+6.1f} % {:>8.1f} % {:>6.1f} % {:>7.2f} {:>8.2f} {:>6.1f} %\n",
      experiment.name, answers, of.name, mean, bias(mean), bias(median), 100.0 * covered / studies,
      100.0 * pse_covered / studies, std::exp(ratio), spread, 100.0 * spread_covered / studies);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int studies = argc > 1 ? std::max(1, std::atoi(argv[1])) : 400;
  const std::string answers = argc > 2 ? argv[2] : "3,10";
  const std::string experiments = argc > 3 && argv[3] != std::string_view("both") ? argv[3] : "";
  const int people = argc > 4 ? std::max(1, std::atoi(argv[4])) : 8;
  fmt::print("{} simulated studies of each kind, {} people, 5 levels; 95 % credible intervals\n\n", studies, people);
  fmt::print(
      "                                             w     mean   median   w held    PSE    high/  spread: s held\n");
  fmt::print("experiment n  people                      mean     bias     bias             held    low    mean\n");
  for (const Experiment& experiment : kExperiments) {
    for (const double n : {3.0, 10.0, 20.0}) {
      for (const Case& of : kCases) {
        const bool wanted = (experiments.empty() || experiments == experiment.name) &&
                            (answers.find(fmt::format("{:g}", n)) != std::string::npos);
        if (wanted) {
          tell(experiment, of, people, n, studies);
        }
      }
    }
  }
}

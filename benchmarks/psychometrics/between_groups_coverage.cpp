// Simulated studies of two groups of people: how often does the interval of their ratio hold the truth, and how often
// does it tell a difference? docs/psychometrics.md has the table this prints.
//
//     haptolith_between_groups_coverage [studies] [people in each group] [answers a level] [experiment]
//     200 8 10 both

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
#include "haptolith/psychometrics/group.h"
#include "haptolith/psychometrics/group_difference.h"

#include "paper_experiments.h"

namespace {

using namespace haptolith;

/// How the two groups are.
struct Case {
  std::string_view name;
  double factor = 1;  // of the second group's w
  double spread = 0;  // of ln w between people
};
constexpr std::array<Case, 6> kCases{{{.name = "no difference, alike"},
                                      {.name = "no difference, ln w differs by 0.3", .spread = 0.3},
                                      {.name = "no difference, ln w differs by 0.6", .spread = 0.6},
                                      {.name = "factor 1.5, alike", .factor = 1.5},
                                      {.name = "factor 1.5, ln w differs by 0.3", .factor = 1.5, .spread = 0.3},
                                      {.name = "factor 1.5, ln w differs by 0.6", .factor = 1.5, .spread = 0.6}}};

struct Size {
  int studies = 200, people = 8;
  double answers = 10;
};

GroupFit groupOf(const Experiment& experiment, const Size& size, double w, double spread, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Level> levels;
  for (const double x : experiment.levels) {
    levels.push_back({x, 0, size.answers});
  }
  std::vector<std::vector<Level>> people;
  for (int i = 0; i < size.people; ++i) {
    people.push_back(
        simulatedAnswers(levels, weberFunction(experiment.reference, w * std::exp(spread * normal(random))), random));
  }
  FitOptions options = weberOptions(experiment.reference);
  options.threshold.reset();
  return fitGroup(people, groupOptions(options), Effort::kQuick);
}

bool holds(const Interval& interval, double value) {
  return interval.low <= value && value <= interval.high;
}

void tell(const Experiment& experiment, const Case& of, const Size& size) {
  std::mt19937_64 random(1);
  const double truth = std::log(of.factor);
  std::vector<double> ratios, factors, lengths;
  int covered = 0, pse_covered = 0, told = 0;
  for (int i = 0; i < size.studies; ++i) {
    const GroupFit first = groupOf(experiment, size, experiment.w, of.spread, random);
    const GroupFit second = groupOf(experiment, size, of.factor * experiment.w, of.spread, random);
    const Change change = changeBetweenGroups(first.scale, second.scale, 0.95);
    const Change pse = changeBetweenGroups(*first.threshold, *second.threshold, 0.95);
    covered += holds(change.mean.interval, truth) ? 1 : 0;
    pse_covered += holds(pse.mean.interval, 0) ? 1 : 0;
    told += holds(change.mean.interval, 0) ? 0 : 1;
    ratios.push_back(std::exp(change.mean.value));
    lengths.push_back(std::exp(change.mean.interval.high - change.mean.interval.low));
    factors.push_back(change.same);
  }
  const auto median = [](std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
  };
  const auto share = [&](int count) { return 100.0 * count / size.studies; };
  fmt::print("{:<9} {:<36} {:>7.3f} {:>8.1f} % {:>8.1f} % {:>8.2f} {:>8.1f} % {:>8.2f}\n", experiment.name, of.name,
             median(ratios), share(covered), share(pse_covered), median(lengths), share(told), median(factors));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int at, int otherwise) { return argc > at ? std::max(1, std::atoi(argv[at])) : otherwise; };
  const Size size{.studies = number(1, 200), .people = number(2, 8), .answers = static_cast<double>(number(3, 10))};
  const std::string experiments = argc > 4 ? argv[4] : "both";
  fmt::print("{} simulated studies of each kind, two groups of {}, {} answers a level; 95 % credible intervals\n\n",
             size.studies, size.people, size.answers);
  fmt::print(
      "                                                median    ratio      PSE's     high/  without  Bayes factor\n");
  fmt::print(
      "experiment people                                ratio     held       held      low       1    of none\n");
  for (const Experiment& experiment : kExperiments) {
    for (const Case& of : kCases) {
      if (experiments == "both" || experiments == experiment.name) {
        tell(experiment, of, size);
      }
    }
  }
}

// Coverage of the interval of the ratio of Weber fractions, and power to detect a difference. Simulated studies of two
// groups of participants, or of one group in two blocks. docs/reports/psychometric-coverage.md has the tables that this
// prints.
//
//     haptolith_difference_coverage [studies] [people in each group] [answers a level] [experiment] [between|within]
//     200 8 10 both between

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
#include "haptolith/psychometrics/group/group_difference.h"

#include "icra2021_experiments.h"

namespace {

using namespace haptolith;

/// Parameters of the two groups, or blocks.
struct Case {
  std::string_view name;
  double factor = 1;  // factor on w in the second
  double spread = 0;  // SD of ln w between participants
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
  bool within = false;  // within participants
};

/// Draws ln w of the participants, relative to the median participant.
std::vector<double> peopleOf(const Size& size, double spread, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<double> people(static_cast<std::size_t>(size.people));
  for (double& person : people) {
    person = spread * normal(random);
  }
  return people;
}

GroupFit groupOf(const Experiment& experiment, const Size& size, double w, const std::vector<double>& ln_w,
                 Effort effort, std::mt19937_64& random) {
  std::vector<Level> levels;
  for (const double x : experiment.levels) {
    levels.push_back({x, 0, size.answers});
  }
  std::vector<std::vector<Level>> people;
  people.reserve(ln_w.size());
  for (const double person : ln_w) {
    people.push_back(simulatedAnswers(levels, weberFunction(experiment.reference, w * std::exp(person)), random));
  }
  FitOptions options = weberOptions(experiment.reference);
  options.threshold.reset();
  return fitGroup(people, groupOptions(options), effort);
}

bool holds(const Interval& interval, double value) {
  return interval.low <= value && value <= interval.high;
}

Change changeOf(const Population& first, const Population& second, const Size& size) {
  if (!size.within) {
    return changeBetweenGroups(first, second, 0.95);
  }
  std::vector<UnderBoth> people;
  for (std::size_t i = 0; i < first.participants.size(); ++i) {
    people.push_back({i, i});
  }
  return changeBetween(first, second, people, 0.95);
}

void tell(const Experiment& experiment, const Case& of, const Size& size) {
  std::mt19937_64 random(1);
  const double truth = std::log(of.factor);
  std::vector<double> ratios, factors, lengths;
  int covered = 0, pse_covered = 0, told = 0;
  for (int i = 0; i < size.studies; ++i) {
    const std::vector<double> some = peopleOf(size, of.spread, random);
    const std::vector<double> others = size.within ? some : peopleOf(size, of.spread, random);
    const Effort effort = size.within ? Effort::kThorough : Effort::kQuick;
    const GroupFit first = groupOf(experiment, size, experiment.w, some, effort, random);
    const GroupFit second = groupOf(experiment, size, of.factor * experiment.w, others, effort, random);
    const Change change = changeOf(first.scale, second.scale, size);
    const Change pse = changeOf(*first.threshold, *second.threshold, size);
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
  const Size size{.studies = number(1, 200),
                  .people = number(2, 8),
                  .answers = static_cast<double>(number(3, 10)),
                  .within = argc > 5 && std::string_view(argv[5]) == "within"};
  const std::string experiments = argc > 4 ? argv[4] : "both";
  fmt::print("{} simulated studies of each kind, {} {}, {} answers a level; 95 % credible intervals\n\n", size.studies,
             size.within ? "two blocks of" : "two groups of", size.people, size.answers);
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

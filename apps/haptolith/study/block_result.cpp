#include "study/block_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "haptolith/core/pluralise.h"

#include "study/fit_report.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kWide = 3;            // high over low end of an uninformative interval
constexpr double kDoubtful = 1.0 / 3;  // Bayes factor for equal participants below which a difference is reported

/// Returns min. and max. JND that the levels can show, over the reference: distances to the nearest and farthest level.
std::optional<Interval> weberFractionsShownBy(const StudyBlock& block) {
  std::optional<Interval> shown;
  for (const Stimulus& level : block.levels) {
    const double distance = std::abs(std::log(level.value / block.reference.value));
    if (std::isfinite(distance) && distance > 0) {
      shown = shown ? Interval{std::min(shown->low, distance), std::max(shown->high, distance)}
                    : Interval{distance, distance};
    }
  }
  return shown ? std::optional(Interval{std::expm1(shown->low), std::expm1(shown->high)}) : std::nullopt;
}

/// Returns warnings about a block's numbers.
std::vector<std::string> remarksOn(const BlockResult& result) {
  std::vector<std::string> remarks;
  const Fit& fit = result.headline();
  const Estimate& w = fit.weber_fraction;
  const bool lapse_fixed = fit.lapse.interval.low == fit.lapse.interval.high;
  remarks.push_back(lapse_fixed ? fmt::format("Lapses: a rate of {:g} is assumed.", fit.lapse.value)
                                : "Lapses: the rate is fitted; its prior is in docs/reference/psychometrics.md.");
  const double reference = result.block->reference.value;
  const Interval& pse = fit.threshold.interval;
  if (pse.high < reference || pse.low > reference) {
    remarks.push_back(fmt::format(
        "The PSE differs from the reference, {:g}, which is outside its interval: tests appear as {} than they are.",
        reference, pse.high < reference ? "more" : "less"));
  }
  if (result.group && result.group->scale.alike < kDoubtful) {
    remarks.push_back(fmt::format(
        "Participants differ in their Weber fractions (Bayes factor of no difference {}, prior half-normal {:g}).",
        bayesFactorText(result.group->scale.alike), result.group->scale.prior.usual));
  }
  if (result.group && result.group->threshold && result.group->threshold->alike < kDoubtful) {
    remarks.push_back(
        fmt::format("Participants differ in their PSEs (Bayes factor of no difference {}, prior half-normal {:.3g}).",
                    bayesFactorText(result.group->threshold->alike), result.group->threshold->prior.usual));
  }
  if (isWeber(fit.function.sigmoid) && w.interval.high > kWide * w.interval.low) {
    remarks.push_back(fmt::format("{} responses of {} leave the Weber fraction uncertain: {:.3g} to {:.3g}.",
                                  fit.n_trials,
                                  result.group ? pluralise(result.codes.size(), "person", "people") : "one person",
                                  w.interval.low, w.interval.high));
  }
  const std::optional<Interval> shown = weberFractionsShownBy(*result.block);
  if (isWeber(fit.function.sigmoid) && shown && (w.value < shown->low || w.value > shown->high)) {
    remarks.push_back(
        fmt::format("The levels resolve Weber fractions of {:.3g} to {:.3g}; estimates outside are unreliable.",
                    shown->low, shown->high));
  }
  if (result.group && !fit.doubt.empty()) {
    remarks.push_back(fmt::format("Doubtful: {}", fit.doubt));
  }
  if (result.group && result.pooled) {
    remarks.emplace_back(
        "The pooled fit ignores differences between participants: if they differ, its curve is too flat and its "
        "intervals are too narrow.");
  }
  return remarks;
}

/// Pairs the results of each participant. @param in_both  number of participants with both.
std::vector<UnderBoth> pairedPeople(const BlockResult& first, const BlockResult& second, std::size_t& in_both) {
  std::vector<UnderBoth> people;
  for (std::size_t i = 0; i < first.codes.size(); ++i) {
    people.push_back({.first = i});
  }
  for (std::size_t i = 0; i < second.codes.size(); ++i) {
    const auto found = std::ranges::find(first.codes, second.codes[i]);
    if (found == first.codes.end()) {
      people.push_back({.second = i});
    } else {
      people[static_cast<std::size_t>(found - first.codes.begin())].second = i;
      ++in_both;
    }
  }
  return people;
}

std::optional<Difference> differenceOf(const BlockResult& first, const BlockResult& second, double confidence) {
  if (!first.group || !second.group || !isWeber(first.group->median_person.function.sigmoid) ||
      !isWeber(second.group->median_person.function.sigmoid)) {
    return std::nullopt;
  }
  Difference difference{.first = &first, .second = &second};
  std::vector<UnderBoth> people;
  if (first.people == second.people) {
    people = pairedPeople(first, second, difference.in_both.emplace(0));
  }
  const auto change = [&](const Population& from, const Population& to, double offset) {
    return difference.in_both ? changeBetween(from, to, people, confidence, offset)
                              : changeBetweenGroups(from, to, confidence, offset);
  };
  difference.scale = change(first.group->scale, second.group->scale, 0);
  if (first.group->threshold && second.group->threshold) {
    const double offset = std::log(second.block->reference.value / first.block->reference.value);
    difference.threshold = change(*first.group->threshold, *second.group->threshold, offset);
  }
  return difference;
}

/// Returns the results of one group, in the order of its blocks; without groups those of all participants.
std::vector<const BlockResult*> resultsIn(const std::vector<BlockResult>& results, const ParticipantGroup* people) {
  std::vector<const BlockResult*> own;
  for (const BlockResult& result : results) {
    if (result.people == people) {
      own.push_back(&result);
    }
  }
  if (people != nullptr) {
    std::ranges::sort(own, {}, [people](const BlockResult* of) {
      return std::ranges::find(people->blocks, of->index) - people->blocks.begin();
    });
  }
  return own;
}

/// Returns the pairs of blocks in which two groups are compared: each common block, and the others in order, the first
/// with the first and so on.
std::vector<std::pair<const BlockResult*, const BlockResult*>> comparable(std::vector<const BlockResult*> first,
                                                                          std::vector<const BlockResult*> second) {
  std::vector<std::pair<const BlockResult*, const BlockResult*>> pairs;
  for (auto one = first.begin(); one != first.end();) {
    const auto same = std::ranges::find(second, (*one)->index, &BlockResult::index);
    if (same == second.end()) {
      ++one;
    } else {
      pairs.emplace_back(*one, *same);
      second.erase(same);
      one = first.erase(one);
    }
  }
  for (std::size_t i = 0; i < std::min(first.size(), second.size()); ++i) {
    pairs.emplace_back(first[i], second[i]);
  }
  return pairs;
}

}  // namespace

std::string text(const BlockResult& result) {
  std::string told =
      fmt::format("{}: {}, reference {} ({:g})\n", result.name(), pluralise(result.codes.size(), "participant"),
                  result.block->reference.name, result.block->reference.value);
  if (result.group) {
    told += groupText(*result.group, result.codes);
  }
  if (result.pooled) {
    told += (result.group ? "\nAll responses pooled. " : "") + fitText(*result.pooled);
  }
  told += "\n";
  for (const std::string& remark : remarksOn(result)) {
    told += remark + "\n";
  }
  if (result.caught) {
    told += fmt::format("Correct catch trials: {:.0f} %\n", 100 * *result.caught);
  }
  return told;
}

nlohmann::ordered_json jsonOf(const BlockResult& result) {
  const Fit& fit = result.headline();
  const auto interval = [](const Interval& it) { return Json::array({it.low, it.high}); };
  Json json{{"block", result.block->name},
            {"axis_label", result.block->axis_label},
            {"reference", result.block->reference.value},
            {"participants", result.codes.size()},
            {"caught", result.caught ? Json(*result.caught) : Json(nullptr)},
            {"headline",
             {{"of", result.group ? "median person" : "one person"},
              {"weber_fraction", fit.weber_fraction.value},
              {"weber_fraction_interval", interval(fit.weber_fraction.interval)},
              {"pse", fit.threshold.value},
              {"pse_interval", interval(fit.threshold.interval)},
              {"jnd", fit.jnd.value},
              {"jnd_interval", interval(fit.jnd.interval)},
              {"lapse", fit.lapse.value},
              {"lapse_interval", interval(fit.lapse.interval)},
              {"n_trials", std::llround(fit.n_trials)}}},
            {"remarks", remarksOn(result)}};
  if (result.people != nullptr) {
    json["of_group"] = result.people->name;
  }
  if (result.group) {
    json["group"] = groupJson(*result.group, result.codes);
  }
  if (result.pooled) {
    json["pooled"] = fitJson(*result.pooled);
  }
  return json;
}

std::vector<Difference> differencesOf(const std::vector<BlockResult>& results, const StudyProtocol& protocol,
                                      double confidence) {
  std::vector<Difference> differences;
  const auto add = [&](const BlockResult& first, const BlockResult& second) {
    if (const std::optional<Difference> difference = differenceOf(first, second, confidence)) {
      differences.push_back(*difference);
    }
  };
  std::vector<std::vector<const BlockResult*>> by_group;
  for (const ParticipantGroup& group : protocol.groups) {
    by_group.push_back(resultsIn(results, &group));
  }
  if (protocol.groups.empty()) {
    by_group.push_back(resultsIn(results, nullptr));
  }
  for (const std::vector<const BlockResult*>& own : by_group) {
    for (std::size_t i = 1; i < own.size(); ++i) {
      add(*own.front(), *own[i]);
    }
  }
  for (std::size_t first = 0; first < by_group.size(); ++first) {
    for (std::size_t second = first + 1; second < by_group.size(); ++second) {
      for (const auto& [one, other] : comparable(by_group[first], by_group[second])) {
        add(*one, *other);
      }
    }
  }
  return differences;
}

std::string text(const Difference& difference, double confidence) {
  const std::string heading =
      fmt::format("{} over {}: {}, population median", difference.second->name(), difference.first->name(),
                  difference.in_both ? fmt::format("{} in both", *difference.in_both) : "different participants");
  return changesText(heading, difference.scale, difference.threshold, confidence);
}

nlohmann::ordered_json jsonOf(const Difference& difference) {
  Json json{{"first", difference.first->block->name}, {"second", difference.second->block->name}};
  if (difference.in_both) {
    json["participants_in_both"] = *difference.in_both;
  } else {
    json["first_group"] = difference.first->people->name;
    json["second_group"] = difference.second->people->name;
  }
  json.update(changesJson(difference.scale, difference.threshold));
  return json;
}

}  // namespace haptolith

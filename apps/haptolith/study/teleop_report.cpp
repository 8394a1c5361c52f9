#include "study/teleop_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "haptolith/core/pluralise.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/site_task.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

std::string meanText(const PeopleMean& mean) {
  if (mean.people == 0) {
    return "-";
  }
  return std::isnan(mean.interval.low)
             ? fmt::format("{:.3g}", mean.mean)
             : fmt::format("{:.3g} ({:.3g} to {:.3g})", mean.mean, mean.interval.low, mean.interval.high);
}

Json numberJson(double value) {
  return std::isnan(value) ? Json(nullptr) : Json(value);
}

Json meanJson(const PeopleMean& mean) {
  return {{"people", mean.people},
          {"mean", numberJson(mean.mean)},
          {"low", numberJson(mean.interval.low)},
          {"high", numberJson(mean.interval.high)}};
}

/// Returns this measure in the first block; null if this is the first, or if that has no such measure.
const TeleopMeasure* inFirst(const std::vector<TeleopBlockResult>& results, const TeleopBlockResult& result,
                             const TeleopMeasure& measure) {
  if (&result == &results.front()) {
    return nullptr;
  }
  const auto found = std::ranges::find(results.front().measures, measure.name, &TeleopMeasure::name);
  return found == results.front().measures.end() ? nullptr : &*found;
}

std::string peopleText(std::size_t people) {
  return pluralise(people, "participant");
}

}  // namespace

std::string teleopTable(const StudyProtocol& protocol, const std::vector<TeleopBlockResult>& results,
                        double confidence) {
  std::string text;
  for (const TeleopBlockResult& result : results) {
    const StudyBlock& block = protocol.blocks[result.block];
    const bool first = &result == &results.front();
    text += fmt::format("\n{}: {}, round trip {}; {}\n  {:<34}{:>30}{:>30}\n", block.name,
                        wordFor(kSiteTaskWords, block.teleop->task), block.reference.name,
                        peopleText(result.measures.front().of_people.size()), "",
                        fmt::format("mean ({:g} % interval)", 100 * confidence),
                        first ? "" : "more than in " + protocol.blocks[results.front().block].name);
    for (const TeleopMeasure& measure : result.measures) {
      const TeleopMeasure* before = inFirst(results, result, measure);
      text += fmt::format("  {:<34}{:>30}{:>30}\n", fmt::format("{} ({})", measure.name, measure.unit),
                          meanText(meanOf(measure, confidence)),
                          before != nullptr ? meanText(meanDifference(measure, *before, confidence)) : "");
    }
  }
  return text;
}

Json teleopJson(const StudyProtocol& protocol, const std::vector<TeleopBlockResult>& results, double confidence) {
  Json blocks = Json::array();
  for (const TeleopBlockResult& result : results) {
    const StudyBlock& block = protocol.blocks[result.block];
    Json measures = Json::array();
    for (const TeleopMeasure& measure : result.measures) {
      const TeleopMeasure* before = inFirst(results, result, measure);
      measures.push_back({{"measure", measure.name},
                          {"unit", measure.unit},
                          {"of_people", meanJson(meanOf(measure, confidence))},
                          {"more_than_first", before != nullptr ? meanJson(meanDifference(measure, *before, confidence))
                                                                : Json(nullptr)}});
    }
    blocks.push_back({{"block", block.name},
                      {"task", wordFor(kSiteTaskWords, block.teleop->task)},
                      {"level", block.reference.name},
                      {"round_trip_s", block.teleop->round_trip_s},
                      {"measures", std::move(measures)}});
  }
  return blocks;
}

}  // namespace haptolith

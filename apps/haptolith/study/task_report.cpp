#include "study/task_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "haptolith/scene_file/scene_words.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

std::string perSecond(const Detectability& found, double duration_s) {
  return fmt::format(
      "{:>7.2f} {:>7.2f}  {:>14}", found.d_prime, found.d_prime / duration_s,
      fmt::format("{:.2f} to {:.2f}", found.interval.low / duration_s, found.interval.high / duration_s));
}

Json jsonOf(const Detectability& found, double duration_s) {
  return {{"d_prime", found.d_prime},
          {"d_prime_per_s", found.d_prime / duration_s},
          {"d_prime_per_s_low", found.interval.low / duration_s},
          {"d_prime_per_s_high", found.interval.high / duration_s}};
}

}  // namespace

std::string taskTable(const std::string& protocol, const TaskPerception& task, const TaskOptions& options) {
  std::string text = fmt::format(
      "{}, block {}: {} against {}. The hand's \"{}\" lasts {:g} s; {} explorations on {} beds of each\n"
      "d' of ideal observers who have force alone, the picture alone, and the picture of the soil without the tool; "
      "per\n"
      "second of exploring, with its 95 % interval\n"
      "  {:>9}  {:<31}  {:<31}  {:<31}\n",
      protocol, task.block, task.axis_label, task.reference, wordFor(kHandMotionWords, task.hand), task.duration_s,
      options.repeats, std::min(options.beds, options.repeats), "level", "force d'    d'/s", "picture d'  d'/s",
      "soil's d'   d'/s");
  for (const TaskLevel& level : task.levels) {
    text += fmt::format("  {:>9}  {}  {}  {}\n", level.name, perSecond(level.force, task.duration_s),
                        perSecond(level.picture, task.duration_s), perSecond(level.soil_picture, task.duration_s));
  }
  text += fmt::format("  {:24} {:>9}", "mean of a cue", task.reference);
  for (const TaskLevel& level : task.levels) {
    text += fmt::format(" {:>9}", level.name);
  }
  for (const TaskCue& cue : task.cues) {
    text += fmt::format("\n  {:24} {:>9.3g}",
                        fmt::format("{} {} ({})", cue.is_seen ? "seen" : "felt", cue.name, cue.unit), cue.reference);
    for (const double mean : cue.levels) {
      text += fmt::format(" {:>9.3g}", mean);
    }
  }
  return text + "\n\n";
}

Json taskJson(const std::string& protocol, const TaskPerception& task, const TaskOptions& options) {
  Json levels = Json::array();
  for (const TaskLevel& level : task.levels) {
    levels.push_back({{"level", level.name},
                      {"value", level.value},
                      {"force", jsonOf(level.force, task.duration_s)},
                      {"picture", jsonOf(level.picture, task.duration_s)},
                      {"picture_of_soil", jsonOf(level.soil_picture, task.duration_s)}});
  }
  Json cues = Json::array();
  for (const TaskCue& cue : task.cues) {
    cues.push_back({{"cue", cue.name},
                    {"unit", cue.unit},
                    {"by", cue.is_seen ? "picture" : "force"},
                    {"reference", cue.reference},
                    {"levels", cue.levels}});
  }
  return {{"protocol", protocol},
          {"block", task.block},
          {"axis_label", task.axis_label},
          {"hand", wordFor(kHandMotionWords, task.hand)},
          {"exploration_s", task.duration_s},
          {"repeats", options.repeats},
          {"seed", options.seed},
          {"sense_scale", options.perceive.sense_scale},
          {"resamplings", options.perceive.observer.resamplings},
          {"reference", task.reference},
          {"levels", levels},
          {"cues", cues}};
}

}  // namespace haptolith

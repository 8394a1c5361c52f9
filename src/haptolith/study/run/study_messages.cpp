#include "haptolith/study/run/study_messages.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/json_reader.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/study/results/answers.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLatest = 100;  ///< maximum number of answers and notes in a message
constexpr int kCurvePoints = 61;
constexpr double kEnoughAnswers = 10;  ///< minimum number of responses for a curve

const char* wordOf(StudyPhase phase) {
  switch (phase) {
    case StudyPhase::kWaiting: return "waiting";
    case StudyPhase::kConsent: return "consent";
    case StudyPhase::kForm: return "form";
    case StudyPhase::kInstructions: return "instructions";
    case StudyPhase::kPreparing: return "preparing";
    case StudyPhase::kInterval: return "interval";
    case StudyPhase::kQuestion: return "question";
    case StudyPhase::kFeedback: return "feedback";
    case StudyPhase::kBreak: return "break";
    case StudyPhase::kFinished: return "finished";
    case StudyPhase::kWithdrawn: return "withdrawn";
    case StudyPhase::kStopped: return "stopped";
  }
  return "";
}

const char* wordOf(FormItem::Kind kind) {
  switch (kind) {
    case FormItem::Kind::kText: return "text";
    case FormItem::Kind::kNumber: return "number";
    case FormItem::Kind::kChoice: return "choice";
    case FormItem::Kind::kScale: return "scale";
    case FormItem::Kind::kYesNo: return "yes-no";
  }
  return "";
}

Json orNull(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

template <class Value>
Json orNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

std::string phaseWord(const StudyState& now) {
  return now.paused ? "paused" : wordOf(now.phase);
}

/// Describes the progress of the preparation before a block's first trial.
std::string preparingText(const StudyState& now) {
  return now.soils > 0 && !now.paused ? fmt::format("Preparing soil {} of {}.", now.soil, now.soils) : "";
}

/// Whether the page has a text for this state.
bool speaksForItself(const StudyState& now) {
  return now.paused || now.phase == StudyPhase::kPreparing || now.phase == StudyPhase::kFeedback ||
         now.phase == StudyPhase::kBreak || now.phase == StudyPhase::kWithdrawn || now.phase == StudyPhase::kStopped;
}

std::string titleOf(const StudyState& now, bool asks) {
  const bool works = now.block != nullptr && now.block->teleop;
  if (works && !now.paused && now.phase == StudyPhase::kFeedback) {
    return now.right.value_or(false) ? "Task completed" : "Time is over";
  }
  return speaksForItself(now) ? "" : asks ? now.block->question : now.title;
}

Json progressJson(const StudyState& now) {
  if (!now.participant.empty() && now.blocks == 0) {
    return nullptr;  // group and blocks are not assigned yet
  }
  return {{"block", std::min(now.position + 1, now.blocks)},
          {"blocks", now.blocks},
          {"trial", now.trial},
          {"trials", now.trials > 0 ? Json(now.trials) : Json(nullptr)}};
}

Json fieldJson(const FormItem& item) {
  const bool any_number = item.kind == FormItem::Kind::kNumber && item.low == item.high;
  Json field{{"key", item.key}, {"label", item.label}, {"kind", wordOf(item.kind)}, {"required", item.required}};
  if (item.kind == FormItem::Kind::kChoice) {
    field["choices"] = item.choices;
  }
  if ((item.kind == FormItem::Kind::kNumber || item.kind == FormItem::Kind::kScale) && !any_number) {
    field["low"] = item.low;
    field["high"] = item.high;
  }
  if (item.kind == FormItem::Kind::kScale) {
    field["low_label"] = item.low_label;
    field["high_label"] = item.high_label;
  }
  return field;
}

Json trialJson(const StudyState& now, const std::optional<ShownTrial>& trial, bool with_interval) {
  if (!trial) {
    return nullptr;
  }
  return {{"kind", wordOf(trial->kind)},
          {"block", trial->block->name},
          {"question", trial->block->teleop ? goalOf(trial->block->teleop->task) : trial->block->question},
          {"reference", trial->block->teleop ? "" : trial->block->reference.name},
          {"test", trial->test->name},
          {"value", trial->test->value},
          {"test_first", trial->test_first},
          {"interval", with_interval && now.interval > 0 ? Json(now.interval) : Json(nullptr)}};
}

/// Describes for the experimenter how the session ended and how to resume.
std::string endingText(const StudyState& now, const std::filesystem::path& file) {
  if (now.phase == StudyPhase::kFinished) {
    return fmt::format("{} has finished.", now.participant);
  }
  if (now.phase == StudyPhase::kWithdrawn) {
    return fmt::format("{} has withdrawn.", now.participant);
  }
  const std::string trials = now.trials > 0  ? fmt::format(" after {} of {} trials", now.trial, now.trials)
                             : now.trial > 0 ? fmt::format(" after {}", pluralise(now.trial, "trial"))
                                             : "";
  const std::string part = now.blocks > 1 ? fmt::format(" in part {} of {}", now.position + 1, now.blocks) : "";
  return fmt::format("{} stopped{}{}; resume with: haptolith study resume {}", now.participant, trials, part,
                     file.string());
}

template <class Row>
std::span<const Row> latest(const std::vector<Row>& rows) {
  return std::span(rows).last(std::min(rows.size(), kLatest));
}

Json notesJson(const Conductor& conductor) {
  const std::vector<NoteRow> all = conductor.store().notes();
  Json notes = Json::array();
  for (const NoteRow& note : latest(all)) {
    notes.push_back({{"at", note.at}, {"kind", note.kind}, {"text", note.text}});
  }
  return notes;
}

Json workJson(const TrialRow& row) {
  if (!row.answer || !row.answer->teleop) {
    return nullptr;
  }
  const TeleopSummary& work = *row.answer->teleop;
  const auto known = [](double value) { return std::isnan(value) ? Json(nullptr) : Json(value); };
  return {{"done", work.done == 1}, {"time_s", known(work.time_s)}, {"force_error", known(work.force_error)}};
}

Json answersJson(const std::vector<TrialRow>& rows) {
  Json answers = Json::array();
  for (const TrialRow& row : latest(rows)) {
    answers.push_back({{"trial", row.index + 1},
                       {"block", row.block_name},
                       {"kind", wordOf(row.kind)},
                       {"test", row.level},
                       {"value", row.value},
                       {"positive", row.answer && !row.answer->teleop ? Json(row.answer->positive) : Json(nullptr)},
                       {"work", workJson(row)},
                       {"correct", row.answer ? orNull(row.answer->correct) : Json(nullptr)},
                       {"reaction_s", row.answer && !row.answer->teleop ? Json(row.answer->reaction_s) : Json(nullptr)},
                       {"state", wordOf(row.state)},
                       {"reason", row.reason}});
  }
  return answers;
}

/// Fits a curve, if there are enough responses, at two levels or more, and not all equal.
Json curveJson(const StudyBlock& block, const std::vector<Level>& levels, Json& result) {
  const auto all_alike = [&levels](double share) {
    return std::ranges::all_of(levels, [share](const Level& level) { return level.k == share * level.n; });
  };
  double answers = 0;
  for (const Level& level : levels) {
    answers += level.n;
  }
  if (answers < kEnoughAnswers || levels.size() < 2 || all_alike(0) || all_alike(1)) {
    return nullptr;
  }
  FitOptions options = fitOptionsOf(block);
  options.simulations = 0;
  const Fit fit = fitPsychometric(levels, options);
  result["threshold"] = fit.threshold.value;
  result["weber_fraction"] = fit.weber_fraction.value;
  const bool log_axis = block.log_axis;
  const double low = std::min(block.levels.front().value, block.reference.value);
  const double high = std::max(block.levels.back().value, block.reference.value);
  Json curve = Json::array();
  for (int i = 0; i < kCurvePoints; ++i) {
    const double share = static_cast<double>(i) / (kCurvePoints - 1);
    const double x = log_axis ? low * std::pow(high / low, share) : low + share * (high - low);
    curve.push_back({x, probability(fit.function, x)});
  }
  return curve;
}

void handleParticipant(Conductor& conductor, const JsonValue& message) {
  const JsonValue act = message.at("act");
  if (act.text() == "go") {
    conductor.proceed();
  } else if (act.text() == "fill") {
    std::map<std::string, std::string> values;
    for (const auto& [key, value] : message.at("values").members()) {
      values[key] = value.text();
    }
    conductor.fill(values);
  } else if (act.text() == "answer") {
    const JsonValue choice = message.at("choice");
    const double number = choice.number({});
    if (number != 0 && number != 1) {
      choice.refuse(choice.given(), "0 or 1");
    }
    conductor.answer(static_cast<int>(number));
  } else if (act.text() == "quit") {
    conductor.withdraw();
  } else {
    act.refuse(act.given(), "go, fill, answer or quit for a participant");
  }
}

void handleExperimenter(Conductor& conductor, const JsonValue& message) {
  const JsonValue act = message.at("act");
  if (act.text() == "pause") {
    conductor.pause();
  } else if (act.text() == "resume") {
    conductor.resume();
  } else if (act.text() == "repeat") {
    const std::string which = message.has("which") ? message.at("which").text() : "now";
    if (which != "now" && which != "last") {
      message.at("which").refuse(inQuotes(which), "now or last");
    }
    conductor.repeat(which == "now" ? Conductor::Again::kNow : Conductor::Again::kLast, message.at("reason").text());
  } else if (act.text() == "note") {
    conductor.note(message.at("text").text());
  } else if (act.text() == "end") {
    conductor.stop();
  } else {
    act.refuse(act.given(), "pause, resume, repeat, note or end for an experimenter");
  }
}

}  // namespace

std::string participantMessage(const Conductor& conductor) {
  const StudyState now = conductor.state();
  const bool works = now.block != nullptr && now.block->teleop;
  const bool asks = !now.paused && now.phase == StudyPhase::kQuestion && !works;
  const bool feels = !now.paused && now.phase == StudyPhase::kInterval;
  Json fields = Json::array();
  if (now.form != nullptr) {
    for (const FormItem& item : *now.form) {
      fields.push_back(fieldJson(item));
    }
  }
  Json message{{"type", "study"},
               {"as", "participant"},
               {"study", conductor.store().title()},
               {"phase", phaseWord(now)},
               {"title", titleOf(now, asks)},
               {"text", speaksForItself(now) ? preparingText(now) : now.text},
               {"fields", std::move(fields)},
               {"button", now.paused ? Json(nullptr) : orNull(now.button)},
               {"interval", now.interval > 0 ? Json(now.interval) : Json(nullptr)},
               {"intervals", works ? 1 : 2},
               {"label", now.interval == 0 ? Json(nullptr)
                         : works           ? Json(goalOf(now.block->teleop->task))
                                           : Json(now.interval == 1 ? "First" : "Second")},
               {"work", orNull(now.work)},
               {"remaining_s", now.paused ? Json(nullptr) : orNull(now.remaining_s)},
               {"choices", asks ? Json(now.block->answers) : Json::array()},
               {"visual", feels && now.block->visual},
               {"visual_delay_s", feels ? now.block->visual_delay_s : 0},
               {"can_dig", feels && conductor.rig().pageMayHold()},
               {"feedback", now.right ? Json(*now.right ? "right" : "wrong") : Json(nullptr)},
               {"progress", progressJson(now)},
               {"ended", conductor.stopped()},
               {"problem", nullptr}};
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string historyJson(const Conductor& conductor) {
  const std::vector<StudyBlock>& blocks = conductor.store().protocol().blocks;
  Json results = Json::array();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i].teleop) {
      continue;  // no curve
    }
    const std::vector<Level> levels = levelsOf(conductor.trials(), i);
    Json points = Json::array();
    for (const Level& level : levels) {
      points.push_back({{"x", level.x}, {"k", level.k}, {"n", level.n}});
    }
    Json result{{"name", blocks[i].name},         {"axis_label", blocks[i].axis_label},
                {"log_axis", blocks[i].log_axis}, {"reference", blocks[i].reference.value},
                {"levels", std::move(points)},    {"curve", nullptr},
                {"threshold", nullptr},           {"weber_fraction", nullptr}};
    Json curve = curveJson(blocks[i], levels, result);
    result["curve"] = std::move(curve);
    results.push_back(std::move(result));
  }
  const Json history{
      {"answers", answersJson(conductor.trials())}, {"blocks", std::move(results)}, {"notes", notesJson(conductor)}};
  return history.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string experimenterMessage(const Conductor& conductor, std::string_view history, double force_n,
                                double peak_force_n) {
  const StudyState now = conductor.state();
  Json message{{"type", "study"},
               {"as", "experimenter"},
               {"study", conductor.store().title()},
               {"file", conductor.store().file().filename().string()},
               {"participant", orNull(now.participant)},
               {"group", orNull(now.group)},
               {"phase", phaseWord(now)},
               {"paused", now.paused},
               {"progress", progressJson(now)},
               {"now", trialJson(now, now.now, true)},
               {"next", trialJson(now, now.next, false)},
               {"force_n", force_n},
               {"peak_force_n", peak_force_n},
               {"ended", conductor.stopped() ? Json(endingText(now, conductor.store().file())) : Json(nullptr)},
               {"problem", orNull(now.problem)}};
  message.update(Json::parse(history));
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

bool handleStudyMessage(Conductor& conductor, std::string_view text, StudyRole role, bool joined) {
  const JsonValue message = parseJson(text, "", "a JSON object");
  const JsonValue act = message.at("act");
  if (act.text() == "join") {
    const JsonValue as = message.at("as");
    const std::string_view own = role == StudyRole::kParticipant ? "participant" : "experimenter";
    if (as.text() != own) {
      as.refuse(as.given(), fmt::format("{}: the address is the {}'s", own, own));
    }
    return true;
  }
  if (!joined) {
    act.refuse(act.given(), "join at first");
  }
  if (role == StudyRole::kParticipant) {
    handleParticipant(conductor, message);
  } else {
    handleExperimenter(conductor, message);
  }
  return true;
}

}  // namespace haptolith

#include "haptolith/study/protocol/protocol.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/former_names.h"
#include "haptolith/scene_file/toml/toml_reader.h"
#include "haptolith/study/protocol/built_in_protocols.h"
#include "haptolith/study/protocol/form.h"
#include "haptolith/study/protocol/protocol_groups.h"
#include "haptolith/study/protocol/protocol_items.h"
#include "haptolith/study/protocol/protocol_keys.h"
#include "haptolith/study/protocol/protocol_levels.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr FileKind kProtocol{
    .name = "protocol", .example_key = "title", .document = "docs/reference/protocol-keys.md", .left_out = "left out"};

/// Rejects keys for trials that the block does not have; otherwise the mistake would stay unnoticed.
void requireCriteria(const StudyBlock& block) {
  const auto refuse = [](const char* key, bool given, const char* why) {
    if (given) {
      throw InvalidParameter(key, "", std::string("left out: ") + why);
    }
  };
  const bool practises = block.practice_trials > 0;
  const bool catches = block.catch_trials > 0;
  refuse("practice_levels", !practises && !block.practice_levels.empty(), "there are no practice_trials");
  refuse("practice_criterion", !practises && block.practice_criterion > 0, "there are no practice_trials");
  refuse("practice_rounds", block.practice_rounds > 1 && block.practice_criterion == 0,
         "there is no practice_criterion");
  refuse("catch_levels", !catches && !block.catch_levels.empty(), "there are no catch_trials");
  refuse("catch_criterion", !catches && block.catch_criterion > 0, "there are no catch_trials");
}

void requireVisualDelay(const StudyBlock& block) {
  if (!block.visual && block.visual_delay_s > 0) {
    throw InvalidParameter("visual_delay_s", fmt::format("{:g}", block.visual_delay_s),
                           "left out: with `visual = false` the scene is not shown");
  }
}

/// Checks that there are levels on both sides of the reference, so that "more" and "less" are distinguishable.
void requireReferenceAmongLevels(const StudyBlock& block) {
  const double low = block.levels.front().value;
  const double high = block.levels.back().value;
  const double value = block.reference.value;
  const bool needed = block.task != TaskKind::kTwoInterval && block.procedure != ProcedureKind::kStaircase;
  if (needed && (value <= low || value >= high)) {
    throw InvalidParameter("reference", "", fmt::format("between the levels, {} to {}; it is at {}", low, high, value));
  }
  if (block.log_axis && (low <= 0 || value <= 0)) {
    throw InvalidParameter("log_axis", "", fmt::format("false: {} has no logarithm", std::min(low, value)));
  }
}

/// Checks that every stimulus makes a valid scene.
void requireScenes(const StudyProtocol& protocol, const StudyBlock& block) {
  const auto require = [&](std::string_view key, const Stimulus& stimulus) {
    try {
      (void)sceneOf(protocol, block, stimulus);
    } catch (const InvalidParameter& error) {
      throw InvalidParameter(std::string(key), stimulus.name,
                             fmt::format("possible in the scene; with '{}': {}", stimulus.name, error.what()));
    }
  };
  require("reference", block.reference);
  for (const Stimulus& level : block.levels) {
    require("levels", level);
  }
  for (const Stimulus& level : block.practice_levels) {
    require("practice_levels", level);
  }
  for (const Stimulus& level : block.catch_levels) {
    require("catch_levels", level);
  }
}

/// Rejects keys of other procedures than the block's; otherwise the mistake would stay unnoticed.
void refuseKeysOfOtherProcedures(const TomlReader& reader, const StudyBlock& block) {
  if (block.procedure != ProcedureKind::kConstant && reader.find("", "repeats") != nullptr) {
    reader.refuseKey({"", "repeats"}, "left out: the procedure ends automatically");
  }
  if (block.procedure != ProcedureKind::kStaircase && reader.has("staircase")) {
    reader.refuseKey({"", "staircase"}, "left out: the procedure is not a staircase");
  }
  if (block.procedure != ProcedureKind::kQuestPlus && reader.has("quest_plus")) {
    reader.refuseKey({"", "quest_plus"}, "left out: the procedure is not quest+");
  }
}

/// Checks the procedure's options by constructing it.
void requireProcedure(StudyBlock& block) {
  block.staircase.log_axis = block.log_axis;
  block.quest_plus.log_axis = block.log_axis;
  std::vector<double> levels;
  std::ranges::transform(block.levels, std::back_inserter(levels), &Stimulus::value);
  const auto make = [&](std::string_view key, const auto& maker, const auto& options) {
    try {
      (void)maker(options, levels, block.reference.value);
    } catch (const InvalidParameter& error) {
      throw InvalidParameter(std::string(key), error.value(), fmt::format("possible: {}", error.what()));
    }
  };
  if (block.procedure == ProcedureKind::kStaircase) {
    make("procedure", makeStaircase, block.staircase);
  } else if (block.procedure == ProcedureKind::kQuestPlus) {
    make("procedure", makeQuestPlus, block.quest_plus);
  }
}

/// Keys for comparisons, which are not valid in blocks of teleoperation.
constexpr std::array kOfComparisons{"question",
                                    "answers",
                                    "varies",
                                    "reference",
                                    "levels",
                                    "values",
                                    "reference_value",
                                    "axis_label",
                                    "log_axis",
                                    "task",
                                    "procedure",
                                    "practice_levels",
                                    "practice_criterion",
                                    "practice_rounds",
                                    "catch_trials",
                                    "catch_levels",
                                    "catch_criterion",
                                    "feedback",
                                    "practice_feedback",
                                    "between_intervals_s",
                                    "answer_limit_s",
                                    "visual_delay_s"};

/// Checks that the robot can dig in its site and that the model can learn.
void requireTeleop(const StudyProtocol& protocol, const StudyBlock& block) {
  const TeleopWork& work = *block.teleop;
  const std::vector<std::string> sites = sceneNames();
  if (std::ranges::find(sites, work.site) == sites.end()) {
    throw InvalidParameter("site", inQuotes(work.site), fmt::format("a built-in scene: {}", fmt::join(sites, ", ")));
  }
  const SceneFile model = sceneOf(protocol, block, block.reference);
  const bool can_learn =
      protocol.scene.bed.soil.friction == FrictionModel::kContact && model.bed.soil.friction == FrictionModel::kContact;
  if (work.force == TeleopForce::kLearning && !can_learn) {
    throw InvalidParameter("felt", "learning", "model or none where the study's scene has no contact friction");
  }
  if (const double tick_s = findSceneFile(work.site).loop.tick_s; tick_s != model.loop.tick_s) {
    throw InvalidParameter("site", inQuotes(work.site),
                           fmt::format("one whose loop has ticks of {:g} s, as the scene's", model.loop.tick_s));
  }
}

/// Reads a teleoperation block; keys common to all blocks have already been read into the draft.
StudyBlock readTeleopBlock(const TomlReader& reader, const StudyProtocol& protocol, const BlockDraft& draft) {
  for (const char* key : kOfComparisons) {
    if (reader.has("", key)) {
      reader.refuseKey({"", key}, "left out: with [block.teleop] nothing is compared");
    }
  }
  for (const char* needed : {"task", "felt", "round_trip_s"}) {
    reader.require("teleop", needed);
  }
  reader.require("", "interval_s");
  StudyBlock block = draft.block;
  block.teleop = draft.teleop;
  block.teleop->site = std::string(currentName(NameKind::kScene, draft.teleop.site));
  if (!(block.interval_s > 0)) {
    reader.refuseKey({"", "interval_s"}, "> 0: with [block.teleop] it is the time limit of a task");
  }
  block.axis_label = "round-trip delay (s)";
  block.reference.name = fmt::format("{} {:g} s", teleopForceWord(block.teleop->force), block.teleop->round_trip_s);
  block.reference.value = block.teleop->round_trip_s;
  block.levels = {block.reference};
  reader.check(blockKeys(), "teleop", [&] { requireTeleop(protocol, block); });
  return block;
}

StudyBlock readBlock(const TomlReader& reader, const StudyProtocol& protocol) {
  std::vector<KeyName> known = keyNames(blockKeys());
  known.push_back({"", "item"});
  reader.refuseUnknownKeys(known);
  reader.refuseBoth("scene", "preset", "soil");
  const bool teleop = reader.has("teleop");
  for (const char* needed : {"name", "question", "answers", "varies", "reference", "levels"}) {
    if (!teleop || std::string_view(needed) == "name") {
      reader.require("", needed);
    }
  }
  BlockDraft draft;
  for (const BlockKey& key : blockKeys()) {
    reader.apply(key, draft);
  }
  StudyBlock& block = draft.block;
  refuseKeysOfOtherProcedures(reader, block);
  if (teleop) {
    block = readTeleopBlock(reader, protocol, draft);
    block.questionnaire = withTaskLoadIndex(draft.task_load_index, readItems(reader, "item"));
    return block;
  }
  if (block.axis_label.empty()) {
    block.axis_label = axisLabelOf(draft.varies);
  }
  reader.check(blockKeys(), "", [&] {
    readStimuli(draft);
    requireCriteria(block);
    requireVisualDelay(block);
    requireReferenceAmongLevels(block);
    requireProcedure(block);
    requireScenes(protocol, block);
  });
  if (block.axis_label.empty()) {
    reader.require("", "axis_label");
  }
  block.questionnaire = withTaskLoadIndex(draft.task_load_index, readItems(reader, "item"));
  return block;
}

/// Returns the built-in scene named by the key; empty: the key is missing or names a file.
std::string builtInScene(const TomlReader& reader) {
  const toml::node* key = reader.find("", "scene");
  const std::string given = key != nullptr ? key->value_or(std::string()) : "";
  const std::string name(currentName(NameKind::kScene, given));
  const std::vector<std::string> names = sceneNames();
  return std::ranges::find(names, name) != names.end() ? name : "";
}

StudyProtocol read(const TomlReader& reader, const SceneFile* scene) {
  std::vector<KeyName> known = keyNames(protocolKeys());
  for (const char* tables : {"block", "demographics", "groups", "item"}) {
    known.push_back({"", tables});
  }
  reader.refuseUnknownKeys(known);
  reader.require("", "title");
  ProtocolDraft draft;
  const std::string built_in = builtInScene(reader);
  for (const ProtocolKey& key : protocolKeys()) {
    if (key.name != "scene" || (scene == nullptr && built_in.empty())) {
      reader.apply(key, draft);
    }
  }
  StudyProtocol& protocol = draft.protocol;
  if (scene != nullptr) {
    protocol.scene = *scene;
  } else if (!built_in.empty()) {
    protocol.scene = findSceneFile(built_in);
  } else if (!draft.scene_file.empty()) {
    protocol.scene = loadSceneFile(draft.scene_file);
  }
  reader.require("", "block");
  for (const TomlReader& part : reader.parts("block")) {
    StudyBlock block = readBlock(part, protocol);
    if (std::ranges::find(protocol.blocks, block.name, &StudyBlock::name) != protocol.blocks.end()) {
      part.refuseKey({"", "name"}, "another one: a block above has it");
    }
    if (block.name == kDemographicsForm || block.name == kQuestionnaireForm) {
      part.refuseKey({"", "name"}, "another one: a form of every study has it");
    }
    protocol.blocks.push_back(std::move(block));
  }
  protocol.demographics = readItems(reader, "demographics");
  protocol.questionnaire = withTaskLoadIndex(draft.task_load_index, readItems(reader, "item"));
  readGroups(reader, protocol);
  return protocol;
}

}  // namespace

StudyProtocol loadProtocol(const fs::path& path) {
  return read(TomlReader(path, kProtocol), nullptr);
}

StudyProtocol loadProtocolText(std::string_view toml, std::string_view name, const SceneFile* scene) {
  return read(TomlReader(fs::path(name), toml, kProtocol), scene);
}

void requireFilledIn(const StudyProtocol& protocol) {
  const std::string_view text = protocol.consent;
  for (std::size_t at = text.find('['); at != std::string_view::npos; at = text.find('[', at + 1)) {
    const std::size_t end = text.find(']', at);
    const bool is_placeholder = at + 1 < text.size() && text[at + 1] >= 'A' && text[at + 1] <= 'Z';
    if (is_placeholder && end != std::string_view::npos) {
      throw InvalidParameter(
          "consent", std::string(text.substr(at, end + 1 - at)),
          "filled in: copy the protocol, replace the text in [BRACKETS], and create a study from the copy");
    }
  }
}

std::vector<std::string_view> protocolNames() {
  std::vector<std::string_view> names;
  std::ranges::transform(builtInProtocols(), std::back_inserter(names), &BuiltInProtocol::name);
  return names;
}

ProtocolText findProtocol(std::string_view name_or_file) {
  const auto same_letter = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  const std::string_view name = currentNameReported(NameKind::kProtocol, name_or_file);
  for (const BuiltInProtocol& protocol : builtInProtocols()) {
    if (std::ranges::equal(name, protocol.name, same_letter)) {
      return {.name = std::string(protocol.name), .text = std::string(protocol.text)};
    }
  }
  const fs::path path(name_or_file);
  std::error_code ignored;  // such as a file name that is too long
  if (!fs::is_regular_file(path, ignored)) {
    throw InvalidParameter(
        "protocol", fmt::format("'{}'", name_or_file),
        fmt::format("{}, or a protocol file (docs/reference/protocol-keys.md)", fmt::join(protocolNames(), ", ")));
  }
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || file.bad()) {
    throw Failure(fmt::format("cannot read {}", path.string()));
  }
  return {.name = path.string(), .text = std::move(text)};
}

SceneFile sceneOf(const StudyProtocol& protocol, const StudyBlock& block, const Stimulus& stimulus) {
  return changed(changed(protocol.scene, block.scene), stimulus.change);
}

std::size_t farthestLevel(const StudyBlock& block) {
  const auto distance = [&](const Stimulus& level) {
    return block.log_axis ? std::abs(std::log(level.value / block.reference.value))
                          : std::abs(level.value - block.reference.value);
  };
  return static_cast<std::size_t>(std::ranges::max_element(block.levels, {}, distance) - block.levels.begin());
}

}  // namespace haptolith

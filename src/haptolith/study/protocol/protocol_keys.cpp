#include "haptolith/study/protocol/protocol_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <system_error>

#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/site_task.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/scene_file/toml/member_keys.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/presets.h"
#include "haptolith/study/protocol/protocol_levels.h"

namespace haptolith {

namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
constexpr Range kAnyNumber{-kNoLimit, kNoLimit};
constexpr Range kSeconds{0, 3600};
constexpr Range kTrials{0, 1000};
constexpr Range kShare{0, 1};
constexpr std::size_t kLongestName = 32;

constexpr Range kVisualDelay_s{0, 5};  // limited by the number of frames that a page can buffer

constexpr std::array kSceneNumbers{
    SceneNumber{"soil_depth_mm", "depth of the soil (mm)", kMillimetres.in_si, &SceneChange::soil_depth_m,
                BedRanges::length_m, "Height of the soil in a bed that starts `packed` or `settled`."},
    SceneNumber{"stone_size_mm", "size of the stone (mm)", kMillimetres.in_si, &SceneChange::stone_size_m, kStoneSize_m,
                "Size of each `[[stone]]` of the scene."},
    SceneNumber{"stone_depth_mm", "depth of the stone (mm)", kMillimetres.in_si, &SceneChange::stone_depth_m,
                StonesRanges::depth_m, "Depth of the centre of each `[[stone]]` below the surface."},
    SceneNumber{"gravity_m_s2", "gravity (m/s²)", 1, &SceneChange::gravity_m_s2, BedRanges::gravity_m_s2,
                "Gravity as a number."},
};

constexpr std::array kOrderWords{
    SceneWord{"fixed", BlockOrder::kFixed},
    SceneWord{"latin-square", BlockOrder::kLatinSquare},
    SceneWord{"random", BlockOrder::kRandom},
};

constexpr std::array kAssignmentWords{
    SceneWord{"alternate", AssignmentMethod::kAlternate},
    SceneWord{"random", AssignmentMethod::kRandom},
    SceneWord{"stratified", AssignmentMethod::kStratified},
};

constexpr std::array kTaskWords{
    SceneWord{"reference-first", TaskKind::kReferenceFirst},
    SceneWord{"random-order", TaskKind::kRandomOrder},
    SceneWord{"two-interval", TaskKind::kTwoInterval},
};

constexpr std::array kProcedureWords{
    SceneWord{"constant", ProcedureKind::kConstant},
    SceneWord{"staircase", ProcedureKind::kStaircase},
    SceneWord{"quest+", ProcedureKind::kQuestPlus},
};

constexpr Range kRoundTrip_s{0, 20};
constexpr std::array kTeleopForceWords{
    SceneWord{"none", TeleopForce::kNone},
    SceneWord{"model", TeleopForce::kModel},
    SceneWord{"learning", TeleopForce::kLearning},
};

constexpr std::array kTargetWords{
    SceneWord{"difference", StaircaseTarget::kDifference},
    SceneWord{"equality", StaircaseTarget::kEquality},
};

constexpr std::array kItemWords{
    SceneWord{"text", FormItem::Kind::kText},     SceneWord{"number", FormItem::Kind::kNumber},
    SceneWord{"choice", FormItem::Kind::kChoice}, SceneWord{"scale", FormItem::Kind::kScale},
    SceneWord{"yes-no", FormItem::Kind::kYesNo},
};

const std::vector<std::string_view> kQuestionnaires{"nasa-tlx"};

/// Checks a name. It becomes the name of columns, files and BIDS tasks, so few characters are allowed.
std::string nameOf(std::string_view key, std::string_view text, std::string_view also) {
  const bool valid = text.size() <= kLongestName && std::ranges::all_of(text, [&](unsigned char letter) {
                       return (letter < 0x80 && std::isalnum(letter) != 0) ||
                              also.find(static_cast<char>(letter)) != std::string_view::npos;
                     });
  if (!valid) {
    throw InvalidParameter(std::string(key), std::string(text),
                           fmt::format("at most {} letters (a to z) and digits{}", kLongestName,
                                       also.empty() ? "" : fmt::format(" and {}", also)));
  }
  return std::string(text);
}

std::vector<std::string> textsOf(const std::vector<TextOrNumber>& items) {
  std::vector<std::string> texts;
  std::ranges::transform(items, std::back_inserter(texts), &TextOrNumber::text);
  return texts;
}

void setAnswers(BlockDraft& draft, const std::vector<TextOrNumber>& items) {
  if (items.size() != 2 || items[0].text.empty() || items[1].text.empty() || items[0].text == items[1].text) {
    throw InvalidParameter("answers", "", "two different texts, the one for \"the test had more\" second");
  }
  draft.block.answers = {items[0].text, items[1].text};
}

std::vector<double> numbersOf(const std::vector<TextOrNumber>& items) {
  std::vector<double> numbers;
  for (const TextOrNumber& item : items) {
    if (!item.number) {
      throw InvalidParameter("", "", fmt::format("numbers; '{}' is not a number", item.text));
    }
    numbers.push_back(*item.number);
  }
  return numbers;
}

BlockKey::ItemsValue ofQuestPlus(std::vector<double> QuestPlusOptions::*numbers) {
  return {"numbers", [numbers](BlockDraft& d, const std::vector<TextOrNumber>& items) {
            d.block.quest_plus.*numbers = numbersOf(items);
          }};
}

/// Sets the design: "equal-asymptote", "yesno", or a number of alternatives: "2afc", "3afc", ...
void setDesign(BlockDraft& draft, std::string_view text) {
  constexpr std::string_view kForced = "afc";
  QuestPlusOptions& options = draft.block.quest_plus;
  if (!text.ends_with(kForced)) {
    options.design = designNamed(text);
    return;
  }
  text.remove_suffix(kForced.size());
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), options.alternatives);
  if (error != std::errc() || end != text.data() + text.size() || options.alternatives < 2 ||
      options.alternatives > 100) {
    throw InvalidParameter("design", fmt::format("'{}afc'", text), "2afc, 3afc, ... or 100afc");
  }
  options.design = Design::kForcedChoice;
}

std::vector<std::string_view> builtInSoilNames() {
  static const std::vector<std::string> kNames = soilNames();
  return {kNames.begin(), kNames.end()};
}

std::vector<ProtocolKey> allProtocolKeys() {
  using D = ProtocolDraft;
  const auto protocol = memberKeys<D>("", &D::protocol);
  const auto assignment = memberKeys<D>("assignment", &D::protocol, &StudyProtocol::assignment);
  return {
      protocol.text("title", &StudyProtocol::title, "Title of the study, shown to participants."),
      protocol.text("consent", &StudyProtocol::consent, "Consent text. Default: no such page.", TextSize::kPage),
      protocol.text("consent_version", &StudyProtocol::consent_version,
                    "Version of the consent text, stored with each consent. Default: its SHA-256."),
      protocol.text("language", &StudyProtocol::language,
                    "Language of the texts (BCP 47); the page has fixed words in `en` and `de`. Default: `en`."),
      {"", "authors", "",
       ProtocolKey::ItemsValue{
           "texts", [](D& d, const std::vector<TextOrNumber>& items) { d.protocol.authors = textsOf(items); }},
       "Authors of the data set, for BIDS."},
      protocol.text("instructions", &StudyProtocol::instructions, "Text before the first block.", TextSize::kPage),
      protocol.text("thanks", &StudyProtocol::thanks, "Text at the end.", TextSize::kPage),
      {"", "scene", "",
       ProtocolKey::PathValue{[](D& d, const std::filesystem::path& v) { d.scene_file = v; }, kOnlyRead},
       "Scene file next to the protocol, or a built-in scene. Default: `icra2021`."},
      protocol.word("order", &StudyProtocol::order, kOrderWords,
                    "Order of the blocks: as listed, balanced over participants, or randomised. Default: `fixed`."),
      protocol.onOrOff("record", &StudyProtocol::record, "Whether trials are recorded. Default: true."),
      {"", "questionnaire", "",
       ProtocolKey::WordValue{kQuestionnaires, [](D& d, std::string_view) { d.task_load_index = true; }, kOnlyRead},
       "Questionnaire after the last block, before `[[item]]`."},
      protocol.count("participants", &StudyProtocol::planned_participants, {1, 10'000},
                     "Number of finished participants to reach (stopping rule). Default: none."),
      assignment.word("method", &GroupAssignment::method, kAssignmentWords,
                      "Alternating, permuted blocks, or permuted blocks within each stratum. Default: `random`."),
      assignment.count("block_size", &GroupAssignment::block_size, {2, 1000},
                       "Participants per permuted block: a multiple of the sum of weights. Default: twice that sum."),
      {"assignment", "strata", "",
       ProtocolKey::ItemsValue{
           "keys of [[demographics]] items",
           [](D& d, const std::vector<TextOrNumber>& items) { d.protocol.assignment.strata = textsOf(items); }},
       "Items for `stratified`: `choice`, `yes-no`, or `number` and `scale` with `cut_points`; `required`, not "
       "`personal`."},
  };
}

std::vector<GroupKey> allGroupKeys() {
  using D = GroupDraft;
  const auto group = memberKeys<D>("", &D::group);
  return {
      {"", "name", "",
       GroupKey::TextValue{[](D& d, std::string_view v) { d.group.name = nameOf("name", v, ""); }, kOnlyRead},
       "Name in tables: letters and digits. Not shown to participants."},
      {"", "blocks", "",
       GroupKey::ItemsValue{"names of blocks",
                            [](D& d, const std::vector<TextOrNumber>& items) { d.blocks = textsOf(items); }},
       "Blocks of the group, in this order with `order = \"fixed\"`. Default: all."},
      group.count("share", &ParticipantGroup::share, {1, 100},
                  "Weight of the group: 2 and 1 give two thirds and one third. Default: 1."),
  };
}

std::vector<BlockKey> designKeys() {
  using D = BlockDraft;
  const auto block = memberKeys<D>("", &D::block);
  const auto draft = memberKeys<D>("");
  return {
      {"", "name", "",
       BlockKey::TextValue{[](D& d, std::string_view v) { d.block.name = nameOf("name", v, ""); }, kOnlyRead},
       "Name in files and tables: letters and digits."},
      block.text("title", &StudyBlock::title, "Title shown to participants. Default: none."),
      block.text("instructions", &StudyBlock::instructions, "Text before the first trial.", TextSize::kPage),
      block.text("hypothesis", &StudyBlock::hypothesis,
                 "Hypothesis for the preregistration, never shown. Default: none.", TextSize::kPage),
      block.text("question", &StudyBlock::question, "Question after the two stimuli.", TextSize::kPage),
      {"", "answers", "", BlockKey::ItemsValue{"two different texts", setAnswers},
       "Left, then right: \"the second had less\", \"the second had more\"; with `two-interval`: first, second "
       "stimulus."},
      {"", "varies", "", BlockKey::WordValue{variedThings(), [](D& d, std::string_view v) { d.varies = v; }, kOnlyRead},
       "Difference between test and reference: preset, body, named soil, or a number of the scene. "
       "`friction_coefficient` is the tangent of the friction angle."},
      {"", "reference", "", BlockKey::ItemsValue{"a name, or a number", [](D& d, const auto& v) { d.reference = v; }},
       "Reference stimulus."},
      {"", "levels", "",
       BlockKey::ItemsValue{"names, or numbers, at least two", [](D& d, const auto& v) { d.levels = v; }},
       "Test stimuli, in any order."},
      {"", "values", "", BlockKey::ItemsValue{"a number for each level", [](D& d, const auto& v) { d.values = v; }},
       "Axis values of `levels`; required for named soils. Default: friction coefficient of a preset (Table II), "
       "gravity of a body, or the number."},
      draft.number("reference_value", &D::reference_value, kAnyNumber,
                   "Axis value of the reference; required with `values`."),
      block.text("axis_label", &StudyBlock::axis_label,
                 "Axis label with unit; required for named soils. Default: name of the variable."),
      block.onOrOff("log_axis", &StudyBlock::log_axis, "Whether curves have a logarithmic axis. Default: false."),
      block.word("task", &StudyBlock::task, kTaskWords,
                 "Reference, then test; the same question in randomised order; or which of the two. Default: "
                 "`reference-first`."),
      block.word("procedure", &StudyBlock::procedure, kProcedureWords,
                 "Selection of levels: a fixed list, or adaptive. Default: `constant`."),
      block.count("repeats", &StudyBlock::repeats, {1, 1000}, "Trials per level, for `constant`. Default: 3."),
  };
}

std::vector<BlockKey> courseKeys() {
  using D = BlockDraft;
  const auto block = memberKeys<D>("", &D::block);
  return {
      block.count("practice_trials", &StudyBlock::practice_trials, kTrials,
                  "Practice trials per round, excluded from fits."),
      {"", "practice_levels", "",
       BlockKey::ItemsValue{"names, or numbers", [](D& d, const auto& v) { d.practice_levels = v; }},
       "Practice stimuli, equally often (± 1), also easier ones. Default: `levels`."},
      block.number("practice_criterion", &StudyBlock::practice_criterion, kShare,
                   "Fraction correct that ends practice; otherwise another round follows. Below it after all rounds: "
                   "reported. Default: 0."),
      block.count("practice_rounds", &StudyBlock::practice_rounds, {1, 20},
                  "Maximum number of practice rounds. Default: 1."),
      block.count("catch_trials", &StudyBlock::catch_trials, kTrials,
                  "Easy trials among the others, to check attention."),
      {"", "catch_levels", "",
       BlockKey::ItemsValue{"names, or numbers", [](D& d, const auto& v) { d.catch_levels = v; }},
       "Catch stimuli, equally often, randomised, also easier ones. Default: level farthest from the reference."},
      block.number("catch_criterion", &StudyBlock::catch_criterion, kShare,
                   "Fraction correct in catch trials below which a participant is reported. Default: 0."),
      block.onOrOff("feedback", &StudyBlock::feedback,
                    "Whether participants see if a response was correct. Default: false."),
      block.onOrOff("practice_feedback", &StudyBlock::practice_feedback, "Feedback in practice. Default: true."),
      block.onOrOff("visual", &StudyBlock::visual, "Whether the scene is visible during a stimulus. Default: true."),
      block.number("visual_delay_s", &StudyBlock::visual_delay_s, kVisualDelay_s,
                   "Delay of the view after the force; earlier frames are shown until then. Default: 0."),
      block.number("interval_s", &StudyBlock::interval_s, kSeconds,
                   "Time limit per stimulus; 0: until the participant continues."),
      block.number("between_intervals_s", &StudyBlock::between_intervals_s, kSeconds,
                   "Pause between the two stimuli. Default: 0.25, enough for any change of soil."),
      block.number("between_trials_s", &StudyBlock::between_trials_s, kSeconds,
                   "Pause between trials, after feedback. Default: 0.25."),
      block.number("answer_limit_s", &StudyBlock::answer_limit_s, kSeconds, "Time limit for a response; 0: none."),
      block.count("break_every_trials", &StudyBlock::break_every_trials, kTrials,
                  "Trials between breaks; 0: no breaks."),
      block.number("break_s", &StudyBlock::break_s, kSeconds, "Minimum duration of a break."),
      {"", "questionnaire", "",
       BlockKey::WordValue{kQuestionnaires, [](D& d, std::string_view) { d.task_load_index = true; }, kOnlyRead},
       "Questionnaire after the block, before `[[block.item]]`."},
  };
}

std::vector<BlockKey> procedureKeys() {
  using D = BlockDraft;
  constexpr Range kFew{1, 10};
  const auto staircase = memberKeys<D>("staircase", &D::block, &StudyBlock::staircase);
  const auto quest_plus = memberKeys<D>("quest_plus", &D::block, &StudyBlock::quest_plus);
  return {
      staircase.word("target", &StaircaseOptions::target, kTargetWords,
                     "Smallest noticeable difference (a staircase on each side of the reference), or point of "
                     "equality. Default: `difference`."),
      staircase.count(
          "staircases", &StaircaseOptions::staircases, kFew,
          "Interleaved staircases, per side with `difference`; with `equality` at alternate ends. Default: 1."),
      staircase.count("down", &StaircaseOptions::down, kFew,
                      "Correct responses in a row before a harder step. Default: 2."),
      staircase.count("up", &StaircaseOptions::up, kFew, "Wrong responses in a row before an easier step. Default: 1."),
      staircase.number("start", &StaircaseOptions::start, kAnyNumber,
                       "Axis value at the start, for `equality`. Default: last level."),
      staircase.count("first_step", &StaircaseOptions::first_step, {1, 100},
                      "Step in levels until the first reversal. Default: 2."),
      staircase.count("step", &StaircaseOptions::step, {1, 100}, "Step in levels after it. Default: 1."),
      staircase.count("reversals", &StaircaseOptions::reversals, {1, 100},
                      "Reversals that end a staircase. Default: 8."),
      staircase.count("uncounted_reversals", &StaircaseOptions::uncounted_reversals, {0, 99},
                      "First reversals, which the result leaves out. Default: 2."),
      staircase.count("most_trials", &StaircaseOptions::most_trials, {1, 1000},
                      "Maximum number of trials. Default: 80."),
      {"quest_plus", "sigmoid", "",
       BlockKey::WordValue{namesOf(kSigmoidNames),
                           [](D& d, std::string_view v) { d.block.quest_plus.sigmoid = sigmoidNamed(v); }, kOnlyRead},
       "Psychometric function. Default: `weber` (paper 22)."},
      {"quest_plus", "design", "", BlockKey::TextValue{setDesign, kOnlyRead},
       "Asymptotes: `equal-asymptote`, `2afc` to `100afc` (levels on one side of the reference), or `yesno`. Default: "
       "`equal-asymptote`."},
      {"quest_plus", "thresholds", "", ofQuestPlus(&QuestPlusOptions::thresholds),
       "Candidate thresholds on the axis. Default: 15 within the levels, about the reference."},
      {"quest_plus", "widths", "", ofQuestPlus(&QuestPlusOptions::widths),
       "Candidate widths; with `weber`, Weber fractions. Default: 25 that the levels can resolve."},
      {"quest_plus", "lapses", "", ofQuestPlus(&QuestPlusOptions::lapses),
       "Candidate lapse rates. Default: 0, 0.02 and 0.05."},
      {"quest_plus", "guesses", "", ofQuestPlus(&QuestPlusOptions::guesses),
       "Candidate guess rates, for `yesno`. Default: 0, 0.02 and 0.05."},
      quest_plus.count("trials", &QuestPlusOptions::trials, {1, 1000}, "Trials that end the procedure. Default: 30."),
      quest_plus.number("enough_spread", &QuestPlusOptions::enough_spread, {0, 10},
                        "SD of ln(width) that ends it earlier. Default: never."),
  };
}

/// Returns the key for a number of the soil in all trials of the block.
BlockKey sliderKey(std::string_view key, const Range& valid, std::string_view meaning) {
  const auto set = [key](BlockDraft& d, double v) { d.block.scene.sliders.emplace_back(std::string(key), v); };
  return {"scene", key, "", BlockKey::NumberValue{valid, set, kOnlyRead}, meaning};
}

std::vector<BlockKey> sceneKeys() {
  using D = BlockDraft;
  std::vector<BlockKey> keys{
      {"scene", "preset", "",
       BlockKey::WordValue{namesOf(presets()), [](D& d, std::string_view v) { d.block.scene.preset = v; }, kOnlyRead},
       "Soil of the ICRA 2021 paper (Table II)."},
      {"scene", "soil", "",
       BlockKey::WordValue{builtInSoilNames(), [](D& d, std::string_view v) { d.block.scene.soil = v; }, kOnlyRead},
       "Named soil; not together with `preset`."},
      {"scene", "body", "",
       BlockKey::WordValue{namesOf(bodies()), [](D& d, std::string_view v) { d.block.scene.body = v; }, kOnlyRead},
       "Celestial body."},
      {"scene", "friction_model", "",
       BlockKey::WordValue{namesOf(kFrictionWords),
                           [](D& d, std::string_view v) { d.block.scene.friction = valueOf(kFrictionWords, v); },
                           kOnlyRead},
       "Friction model (scenes.md)."},
      sliderKey("friction_angle_deg", {1, 70}, "Friction angle of the soil; for `icra2021` friction."),
      sliderKey("cohesion_pa", {0, kNoLimit}, "Cohesion of the soil; for `icra2021` friction."),
  };
  for (const SoilNumber& number : kSoilNumbers) {
    if (const SoilControl& control = number.control; !control.key.empty()) {
      const bool scales = number.radius_power != 0;
      keys.push_back(sliderKey(control.key, {0, scales ? kNoLimit : control.highest}, control.meaning));
    }
  }
  for (const SceneNumber& number : kSceneNumbers) {
    const auto set = [number](D& d, double v) { d.block.scene.*number.member = v * number.unit; };
    keys.push_back(
        {"scene", number.key, "", BlockKey::NumberValue{number.valid.in(number.unit), set, kOnlyRead}, number.meaning});
  }
  return keys;
}

std::vector<BlockKey> teleopKeys() {
  using D = BlockDraft;
  const auto teleop = memberKeys<D>("teleop", &D::teleop);
  return {
      teleop.word(
          "task", &TeleopWork::task, kSiteTaskWords,
          "Trench 40 mm deep and 60 mm long; press with 8 N ± 10 % for 0.5 s; or load of 0.1 N lifted for 0.5 s."),
      teleop.word("felt", &TeleopWork::force, kTeleopForceWords,
                  "Force at the hand: none, from the block's scene as a static model, or from a learning one."),
      teleop.number("round_trip_s", &TeleopWork::round_trip_s, kRoundTrip_s, "Round-trip delay, half of it each way."),
      teleop.text("site", &TeleopWork::site,
                  "Built-in scene of the robot, level in each trial. Default: `teleop-site`."),
  };
}

/// Uses the file's names as parameter names, for the messages of checks between values.
template <class Key>
std::vector<Key> named(std::vector<Key> keys) {
  for (Key& key : keys) {
    key.parameter = key.name;
  }
  return keys;
}

std::vector<BlockKey> allBlockKeys() {
  std::vector<BlockKey> keys = designKeys();
  for (const std::vector<BlockKey>& more : {courseKeys(), sceneKeys(), procedureKeys(), teleopKeys()}) {
    keys.insert(keys.end(), more.begin(), more.end());
  }
  return keys;
}

std::vector<ItemKey> allItemKeys() {
  const auto item = memberKeys<FormItem>("");
  return {
      {"", "key", "",
       ItemKey::TextValue{[](FormItem& i, std::string_view v) { i.key = nameOf("key", v, "_"); }, kOnlyRead},
       "Name in tables: letters, digits and _."},
      item.text("label", &FormItem::label, "Question.", TextSize::kPage),
      item.word("kind", &FormItem::kind, kItemWords, "Type of answer. Default: `text`."),
      {"", "choices", "",
       ItemKey::ItemsValue{"texts, at least two", [](FormItem& i, const auto& v) { i.choices = textsOf(v); }},
       "Options of a `choice`."},
      item.number("low", &FormItem::low, kAnyNumber, "Minimum of a number, or left end of a scale."),
      item.number("high", &FormItem::high, kAnyNumber, "Maximum of a number, or right end of a scale."),
      item.text("low_label", &FormItem::low_label, "Label of the left end of a scale."),
      item.text("high_label", &FormItem::high_label, "Label of the right end of a scale."),
      {"", "cut_points", "",
       ItemKey::ItemsValue{"numbers, the least first", [](FormItem& i, const auto& v) { i.cut_points = numbersOf(v); }},
       "Limits between strata; each belongs to the part above."},
      item.onOrOff("required", &FormItem::required, "Whether an answer is required. Default: false."),
      item.onOrOff("personal", &FormItem::personal,
                   "Whether the answer could identify the participant. Default: false."),
  };
}

}  // namespace

std::span<const ProtocolKey> protocolKeys() {
  static const std::vector<ProtocolKey> kKeys = named(allProtocolKeys());
  return kKeys;
}

std::span<const GroupKey> groupKeys() {
  static const std::vector<GroupKey> kKeys = named(allGroupKeys());
  return kKeys;
}

std::span<const BlockKey> blockKeys() {
  static const std::vector<BlockKey> kKeys = named(allBlockKeys());
  return kKeys;
}

std::span<const ItemKey> itemKeys() {
  static const std::vector<ItemKey> kKeys = named(allItemKeys());
  return kKeys;
}

std::string_view teleopForceWord(TeleopForce force) {
  return wordFor(kTeleopForceWords, force);
}

std::span<const SceneNumber> sceneNumbers() {
  return kSceneNumbers;
}

}  // namespace haptolith

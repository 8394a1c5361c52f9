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

constexpr Range kVisualDelay_s{0, 5};  // so many pictures a page can hold back

constexpr std::array kSceneNumbers{
    SceneNumber{"soil_depth_mm", "depth of the soil (mm)", kMillimetres.in_si, &SceneChange::soil_depth_m,
                BedRanges::length_m, "Height of the soil, of a bed that starts `packed` or `settled`."},
    SceneNumber{"stone_size_mm", "size of the stone (mm)", kMillimetres.in_si, &SceneChange::stone_size_m, kStoneSize_m,
                "Size of each [[stone]] of the scene."},
    SceneNumber{"stone_depth_mm", "depth of the stone (mm)", kMillimetres.in_si, &SceneChange::stone_depth_m,
                StonesRanges::depth_m, "How deep the middle of each [[stone]] lies below the surface."},
    SceneNumber{"gravity_m_s2", "gravity (m/s²)", 1, &SceneChange::gravity_m_s2, BedRanges::gravity_m_s2,
                "Gravity by its number."},
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

/// Names become names of columns, files and BIDS tasks, hence so few letters.
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

/// "equal-asymptote", "yesno", or how many alternatives there are: "2afc", "3afc", ...
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
      protocol.text("title", &StudyProtocol::title, "Title of the study, on one line; shown to participants."),
      protocol.text("consent", &StudyProtocol::consent,
                    "Consent text, shown first; blank lines separate paragraphs. Left out: no consent page.",
                    TextSize::kPage),
      protocol.text("consent_version", &StudyProtocol::consent_version,
                    "Version of the consent text (a date, a number), stored with each consent. Left out: its SHA-256."),
      protocol.text("language", &StudyProtocol::language,
                    "Language of the texts, as a BCP 47 tag; the participant's page has fixed words in `en` and `de`. "
                    "Left out: `en`."),
      {"", "authors", "",
       ProtocolKey::ItemsValue{
           "texts", [](D& d, const std::vector<TextOrNumber>& items) { d.protocol.authors = textsOf(items); }},
       "Authors of the study, for BIDS exports: a text for each person."},
      protocol.text("instructions", &StudyProtocol::instructions, "Instructions before the first block.",
                    TextSize::kPage),
      protocol.text("thanks", &StudyProtocol::thanks, "Text at the end of the study.", TextSize::kPage),
      {"", "scene", "",
       ProtocolKey::PathValue{[](D& d, const std::filesystem::path& v) { d.scene_file = v; }, kOnlyRead},
       "A scene file (scenes.md), next to the protocol, or the name of a built-in scene; left out: the paper's scene."},
      protocol.word("order", &StudyProtocol::order, kOrderWords,
                    "In what order a participant comes to the blocks: as they stand, balanced over participants, or "
                    "drawn for each; left out: `fixed`."),
      protocol.onOrOff("record", &StudyProtocol::record,
                       "Whether each trial is recorded in a separate file (recording.md); left out: true."),
      {"", "questionnaire", "",
       ProtocolKey::WordValue{kQuestionnaires, [](D& d, std::string_view) { d.task_load_index = true; }, kOnlyRead},
       "A questionnaire after the last block, before the items of `[[item]]`."},
      protocol.count("participants", &StudyProtocol::planned_participants, {1, 10'000},
                     "Number of participants that should finish: the stopping rule, reported by `study status` and the "
                     "preregistration. Left out: no rule."),
      assignment.word("method", &GroupAssignment::method, kAssignmentWords,
                      "Allocation to groups: alternating, in permuted blocks (each group in proportion to its share, "
                      "in random order), or in permuted blocks within each stratum; left out: `random`."),
      assignment.count(
          "block_size", &GroupAssignment::block_size, {2, 1000},
          "How many participants a permuted block has: a multiple of the sum of all shares; left out: twice that sum."),
      {"assignment", "strata", "",
       ProtocolKey::ItemsValue{
           "keys of [[demographics]] items",
           [](D& d, const std::vector<TextOrNumber>& items) { d.protocol.assignment.strata = textsOf(items); }},
       "Whose answers make the strata, for `stratified`: items of the kinds `choice` and `yes-no`, and numbers and "
       "scales with `cut_points`, that are `required` and not `personal`."},
  };
}

std::vector<GroupKey> allGroupKeys() {
  using D = GroupDraft;
  const auto group = memberKeys<D>("", &D::group);
  return {
      {"", "name", "",
       GroupKey::TextValue{[](D& d, std::string_view v) { d.group.name = nameOf("name", v, ""); }, kOnlyRead},
       "Name of the group in tables: letters and digits. It is not shown to participants."},
      {"", "blocks", "",
       GroupKey::ItemsValue{"names of blocks",
                            [](D& d, const std::vector<TextOrNumber>& items) { d.blocks = textsOf(items); }},
       "The blocks that the group goes through, with `order = \"fixed\"` in this order; left out: all of them."},
      group.count("share", &ParticipantGroup::share, {1, 100},
                  "Its part of the participants, over the sum of all shares: 2 and 1 are two thirds and one third. "
                  "Left out: 1."),
  };
}

std::vector<BlockKey> designKeys() {
  using D = BlockDraft;
  const auto block = memberKeys<D>("", &D::block);
  const auto draft = memberKeys<D>("");
  return {
      {"", "name", "",
       BlockKey::TextValue{[](D& d, std::string_view v) { d.block.name = nameOf("name", v, ""); }, kOnlyRead},
       "Name of the block in files and tables: letters and digits."},
      block.text("title", &StudyBlock::title, "Title that is shown to participants; left out: none."),
      block.text("instructions", &StudyBlock::instructions, "Instructions before its first trial.", TextSize::kPage),
      block.text("hypothesis", &StudyBlock::hypothesis,
                 "Hypothesis for the preregistration; not shown while the study runs. Left out: none.",
                 TextSize::kPage),
      block.text("question", &StudyBlock::question, "Question after the two stimuli.", TextSize::kPage),
      {"", "answers", "", BlockKey::ItemsValue{"two different texts", setAnswers},
       "The two answers, left and right: first \"the second had less\", then \"the second had more\"; with "
       "`two-interval` the first and the second stimulus."},
      {"", "varies", "", BlockKey::WordValue{variedThings(), [](D& d, std::string_view v) { d.varies = v; }, kOnlyRead},
       "Difference between test and reference: the soil as a preset or by name, the celestial body, or one number of "
       "the scene (`[block.scene]` has them). `friction_coefficient` is the tangent of the friction angle, of which "
       "the paper's Weber fraction is one: 0.29 of it is 0.18 of an angle of 40°."},
      {"", "reference", "", BlockKey::ItemsValue{"a name, or a number", [](D& d, const auto& v) { d.reference = v; }},
       "Stimulus that each test is compared with."},
      {"", "levels", "",
       BlockKey::ItemsValue{"names, or numbers, at least two", [](D& d, const auto& v) { d.levels = v; }},
       "Stimuli that are compared with the reference, in any order; at least two."},
      {"", "values", "", BlockKey::ItemsValue{"a number for each level", [](D& d, const auto& v) { d.values = v; }},
       "Values of the levels on the axis, in the same order; needed for soils by name. Left out: a preset's "
       "coefficient of friction (paper, Table II), a body's gravity, a number itself."},
      draft.number("reference_value", &D::reference_value, kAnyNumber,
                   "Value of the reference on the axis; needed with `values`."),
      block.text(
          "axis_label", &StudyBlock::axis_label,
          "Label of the axis, with its unit; left out: the name of the varied quantity. Needed for soils by name."),
      block.onOrOff("log_axis", &StudyBlock::log_axis, "Whether curves are drawn over the logarithm; left out: false."),
      block.word("task", &StudyBlock::task, kTaskWords,
                 "Order and question: reference, then test; the same question in random order; or which of the two. "
                 "Left out: `reference-first`, the paper's."),
      block.word("procedure", &StudyBlock::procedure, kProcedureWords,
                 "Choice of the levels: a fixed list, or adaptive; left out: `constant`."),
      block.count("repeats", &StudyBlock::repeats, {1, 1000},
                  "How often each level is shown; for `constant`. Left out: 3."),
  };
}

std::vector<BlockKey> courseKeys() {
  using D = BlockDraft;
  const auto block = memberKeys<D>("", &D::block);
  return {
      block.count("practice_trials", &StudyBlock::practice_trials, kTrials,
                  "Practice trials before the others, which do not count."),
      {"", "practice_levels", "",
       BlockKey::ItemsValue{"names, or numbers", [](D& d, const auto& v) { d.practice_levels = v; }},
       "Stimuli of the practice trials, each equally often (within one): levels, or easier ones. Left out: the "
       "levels."},
      block.number(
          "practice_criterion", &StudyBlock::practice_criterion, kShare,
          "Fraction of correct answers in a round of practice that ends practice; otherwise another round follows, up "
          "to `practice_rounds`. A participant who never reaches it continues, and is reported. Left out: 0."),
      block.count("practice_rounds", &StudyBlock::practice_rounds, {1, 20},
                  "Rounds of `practice_trials` trials at most; left out: 1."),
      block.count("catch_trials", &StudyBlock::catch_trials, kTrials,
                  "Easy trials among the others: they show whether a participant attends."),
      {"", "catch_levels", "",
       BlockKey::ItemsValue{"names, or numbers", [](D& d, const auto& v) { d.catch_levels = v; }},
       "Stimuli of the catch trials, each equally often, in random order: levels, or easier ones. Left out: the level "
       "farthest from the reference."},
      block.number("catch_criterion", &StudyBlock::catch_criterion, kShare,
                   "Share of right answers in catch trials below which a participant is reported; left out: 0."),
      block.onOrOff("feedback", &StudyBlock::feedback,
                    "Whether the page shows if an answer was correct; left out: false."),
      block.onOrOff("practice_feedback", &StudyBlock::practice_feedback,
                    "Whether the page shows this in practice trials; left out: true."),
      block.onOrOff("visual", &StudyBlock::visual,
                    "Whether the scene is seen while it is felt; false for haptics alone. Left out: true."),
      block.number("visual_delay_s", &StudyBlock::visual_delay_s, kVisualDelay_s,
                   "How much later than the force its picture is seen; left out: 0. Until then the picture shows the "
                   "soil as it was before."),
      block.number("interval_s", &StudyBlock::interval_s, kSeconds,
                   "Longest time with one stimulus; 0: until the participant continues."),
      block.number("between_intervals_s", &StudyBlock::between_intervals_s, kSeconds,
                   "From the end of the first stimulus to the beginning of the second; left out: 0.25, which is long "
                   "enough for any change of soil."),
      block.number("between_trials_s", &StudyBlock::between_trials_s, kSeconds,
                   "From the answer, or the end of its feedback, to the next first stimulus; left out: 0.25."),
      block.number("answer_limit_s", &StudyBlock::answer_limit_s, kSeconds, "Longest time for an answer; 0: none."),
      block.count("break_every_trials", &StudyBlock::break_every_trials, kTrials,
                  "After how many trials a break comes; 0: no breaks."),
      block.number("break_s", &StudyBlock::break_s, kSeconds, "Shortest length of a break."),
      {"", "questionnaire", "",
       BlockKey::WordValue{kQuestionnaires, [](D& d, std::string_view) { d.task_load_index = true; }, kOnlyRead},
       "A questionnaire after the block, before the items of `[[block.item]]`."},
  };
}

std::vector<BlockKey> procedureKeys() {
  using D = BlockDraft;
  constexpr Range kFew{1, 10};
  const auto staircase = memberKeys<D>("staircase", &D::block, &StudyBlock::staircase);
  const auto quest_plus = memberKeys<D>("quest_plus", &D::block, &StudyBlock::quest_plus);
  return {
      staircase.word("target", &StaircaseOptions::target, kTargetWords,
                     "The least difference that is noticed, by a staircase on each side of the reference, or the level "
                     "that feels like the reference; left out: `difference`."),
      staircase.count("staircases", &StaircaseOptions::staircases, kFew,
                      "How many take turns, with `difference` on each side of the reference; with `equality` every "
                      "second one begins at the other end. Left out: 1."),
      staircase.count("down", &StaircaseOptions::down, kFew,
                      "Right answers in a row that lead a step on; left out: 2."),
      staircase.count("up", &StaircaseOptions::up, kFew, "Wrong answers in a row that lead a step back; left out: 1."),
      staircase.number("start", &StaircaseOptions::start, kAnyNumber,
                       "With `equality`, where on the axis it begins; left out: at the last level."),
      staircase.count("first_step", &StaircaseOptions::first_step, {1, 100},
                      "Levels at a time until the first reversal; left out: 2."),
      staircase.count("step", &StaircaseOptions::step, {1, 100}, "Levels at a time after it; left out: 1."),
      staircase.count("reversals", &StaircaseOptions::reversals, {1, 100},
                      "Reversals that end a staircase; left out: 8."),
      staircase.count("uncounted_reversals", &StaircaseOptions::uncounted_reversals, {0, 99},
                      "How many of them, the first, do not count for the result; left out: 2."),
      staircase.count("most_trials", &StaircaseOptions::most_trials, {1, 1000},
                      "Trials that end the procedure in any case; left out: 80."),
      {"quest_plus", "sigmoid", "",
       BlockKey::WordValue{namesOf(kSigmoidNames),
                           [](D& d, std::string_view v) { d.block.quest_plus.sigmoid = sigmoidNamed(v); }, kOnlyRead},
       "Shape of the psychometric function; left out: `weber` (paper 22)."},
      {"quest_plus", "design", "", BlockKey::TextValue{setDesign, kOnlyRead},
       "Its asymptotes: `equal-asymptote` (lapses are \"more\" as often as \"less\"), `2afc`, `3afc`, ... `100afc` (a "
       "lower asymptote of one half, one third, ...: the levels lie on one side of the reference), or `yesno` (a "
       "separate lower asymptote). Left out: `equal-asymptote`."},
      {"quest_plus", "thresholds", "", ofQuestPlus(&QuestPlusOptions::thresholds),
       "Possible thresholds, on the axis; left out: 15 within the levels, around the reference."},
      {"quest_plus", "widths", "", ofQuestPlus(&QuestPlusOptions::widths),
       "Possible widths, with `weber` Weber fractions; left out: 25 that the levels can resolve."},
      {"quest_plus", "lapses", "", ofQuestPlus(&QuestPlusOptions::lapses),
       "Possible lapse rates; left out: 0, 0.02 and 0.05."},
      {"quest_plus", "guesses", "", ofQuestPlus(&QuestPlusOptions::guesses),
       "Possible lower asymptotes, for `yesno`; left out: 0, 0.02 and 0.05."},
      quest_plus.count("trials", &QuestPlusOptions::trials, {1, 1000}, "Trials that end the procedure; left out: 30."),
      quest_plus.number(
          "enough_spread", &QuestPlusOptions::enough_spread, {0, 10},
          "Ends it before, once the logarithm of the width is known with this standard deviation; left out: never."),
  };
}

/// A number that the soil of the whole block is given.
BlockKey sliderKey(std::string_view key, const Range& valid, std::string_view meaning) {
  const auto set = [key](BlockDraft& d, double v) { d.block.scene.sliders.emplace_back(std::string(key), v); };
  return {"scene", key, "", BlockKey::NumberValue{valid, set, kOnlyRead}, meaning};
}

std::vector<BlockKey> sceneKeys() {
  using D = BlockDraft;
  std::vector<BlockKey> keys{
      {"scene", "preset", "",
       BlockKey::WordValue{namesOf(presets()), [](D& d, std::string_view v) { d.block.scene.preset = v; }, kOnlyRead},
       "Soil of the paper's Table II."},
      {"scene", "soil", "",
       BlockKey::WordValue{builtInSoilNames(), [](D& d, std::string_view v) { d.block.scene.soil = v; }, kOnlyRead},
       "A soil with a name; not together with a preset."},
      {"scene", "body", "",
       BlockKey::WordValue{namesOf(bodies()), [](D& d, std::string_view v) { d.block.scene.body = v; }, kOnlyRead},
       "The celestial body."},
      {"scene", "friction", "",
       BlockKey::WordValue{namesOf(kFrictionWords),
                           [](D& d, std::string_view v) { d.block.scene.friction = valueOf(kFrictionWords, v); },
                           kOnlyRead},
       "Friction model (scenes.md)."},
      sliderKey("friction_angle_deg", {1, 70}, "Friction angle of the soil; for `paper` friction."),
      sliderKey("cohesion_pa", {0, kNoLimit}, "Its cohesion; for `paper` friction."),
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
      teleop.word("task", &TeleopWork::task, kSiteTaskWords,
                  "Task at the robot's site: a trench 40 mm deep and 60 mm long, the tool's face pressed on the soil "
                  "with 8 N, within a tenth and for half a second, or a load of 0.1 N held in the air for as long."),
      teleop.word("felt", &TeleopWork::force, kTeleopForceWords,
                  "Rendered force: none, the block's scene as a static model, or as a model that adapts to the robot's "
                  "forces and camera."),
      teleop.number("round_trip_s", &TeleopWork::round_trip_s, kRoundTrip_s,
                    "Delay to the robot and back; half of it each way."),
      teleop.text("site", &TeleopWork::site,
                  "The built-in scene that the robot digs in, level in each trial; left out: `dig-site`."),
  };
}

/// Checks of values against each other call a parameter what the file calls it.
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
       "Name of the answer in tables: letters, digits and _."},
      item.text("label", &FormItem::label, "The question.", TextSize::kPage),
      item.word("kind", &FormItem::kind, kItemWords, "Type of the answer; left out: `text`."),
      {"", "choices", "",
       ItemKey::ItemsValue{"texts, at least two", [](FormItem& i, const auto& v) { i.choices = textsOf(v); }},
       "Choices; for `choice`."},
      item.number("low", &FormItem::low, kAnyNumber, "Minimum of a number, or the left end of a scale."),
      item.number("high", &FormItem::high, kAnyNumber, "Maximum of a number, or the right end of a scale."),
      item.text("low_label", &FormItem::low_label, "Label of the left end of a scale."),
      item.text("high_label", &FormItem::high_label, "Label of the right end of a scale."),
      {"", "cut_points", "",
       ItemKey::ItemsValue{"numbers, the least first", [](FormItem& i, const auto& v) { i.cut_points = numbersOf(v); }},
       "Where a number or scale is cut into strata, for `[assignment] strata`; a cut belongs to the part above it."},
      item.onOrOff("required", &FormItem::required, "Whether an answer is required; left out: false."),
      item.onOrOff("personal", &FormItem::personal,
                   "Whether the answer could identify the participant: it is kept apart, and exported only when asked "
                   "for. Left out: false."),
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

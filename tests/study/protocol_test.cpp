#include "haptolith/study/protocol/protocol.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"
#include "haptolith/study/protocol/protocol_keys.h"

#include "../source_dir.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kTitle = "title = 'x'\n";
const std::string kNames = "[[block]]\nname = 'a'\nquestion = 'Which?'\nanswers = ['less', 'more']\n";
const std::string kFriction = "varies = 'preset'\nreference = 'P3'\nlevels = ['P1', 'P6']\n";

StudyProtocol load(const std::string& text) {
  return loadProtocolText(text, "x.toml");
}

std::string errorOf(const std::string& text) {
  try {
    (void)load(text);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "no error";
}

std::string readSource(const std::string& name) {
  std::ifstream file(sourceDir() / name);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<std::string> names(const std::vector<Stimulus>& stimuli) {
  std::vector<std::string> names;
  std::ranges::transform(stimuli, std::back_inserter(names), &Stimulus::name);
  return names;
}

std::vector<double> values(const std::vector<Stimulus>& stimuli) {
  std::vector<double> values;
  std::ranges::transform(stimuli, std::back_inserter(values), &Stimulus::value);
  return values;
}

// --- what ships
// -------------------------------------------------------------------------------------------------------

TEST(ShippedProtocols, AreAllValid) {
  ASSERT_GE(protocolNames().size(), 4U);
  for (const std::string_view name : protocolNames()) {
    const ProtocolText found = findProtocol(name);
    const StudyProtocol protocol = loadProtocolText(found.text, found.name);
    EXPECT_FALSE(protocol.consent.empty()) << name;
    EXPECT_THAT(protocol.consent, HasSubstr("[NAME OF THE LABORATORY")) << name;
    for (const StudyBlock& block : protocol.blocks) {
      EXPECT_FALSE(block.instructions.empty()) << name;
    }
  }
}

TEST(ShippedProtocols, AreTheFilesInTheirFolder) {
  EXPECT_EQ(findProtocol("ICRA2021").text, readSource("protocols/icra2021.toml"));
  EXPECT_EQ(findProtocol("PAPER").text, readSource("protocols/icra2021.toml")) << "the name of earlier versions";
  EXPECT_THROW((void)findProtocol(std::string(300, 'x')), InvalidParameter) << "no file can have that name";
}

TEST(ShippedProtocols, HaveThePapersFrictionExperiment) {
  const StudyProtocol protocol = load(findProtocol("icra2021-friction").text);
  ASSERT_EQ(protocol.blocks.size(), 1U);
  const StudyBlock& block = protocol.blocks[0];
  EXPECT_THAT(names(block.levels), ElementsAre("P6", "P5", "P4", "P2", "P1"));
  EXPECT_THAT(values(block.levels), ElementsAre(0.600, 0.648, 0.735, 1.00, 1.21));  // Table II, desired mu
  EXPECT_EQ(block.reference.name, "P3");
  EXPECT_EQ(block.reference.value, 0.835);
  EXPECT_EQ(block.repeats, 3);
  EXPECT_EQ(block.task, TaskKind::kReferenceFirst);
  EXPECT_EQ(block.procedure, ProcedureKind::kConstant);
  EXPECT_FALSE(block.log_axis);
  EXPECT_TRUE(block.visual);
  EXPECT_EQ(block.practice_trials + block.catch_trials, 0);
}

TEST(ShippedProtocols, HaveThePapersGravityExperimentWithP4) {
  const StudyProtocol protocol = load(findProtocol("icra2021-gravity").text);
  const StudyBlock& block = protocol.blocks.at(0);
  EXPECT_THAT(names(block.levels), ElementsAre("Ceres", "Pluto", "Europa", "Mars", "Earth"));
  EXPECT_THAT(values(block.levels), ElementsAre(0.270, 0.625, 1.314, 3.721, 9.807));
  EXPECT_EQ(block.reference.value, 1.625);
  EXPECT_TRUE(block.log_axis);
  const SceneFile mars = sceneOf(protocol, block, block.levels[3]);
  EXPECT_EQ(mars.preset, "P4");
  EXPECT_EQ(mars.bed.soil, findPreset("P4").soil);
  EXPECT_DOUBLE_EQ(mars.bed.gravity_m_s2.z(), -3.721);
}

TEST(ShippedProtocols, HaveBothInTurns) {
  const StudyProtocol protocol = load(findProtocol("icra2021").text);
  ASSERT_EQ(protocol.blocks.size(), 2U);
  EXPECT_EQ(protocol.order, BlockOrder::kLatinSquare);
}

TEST(ShippedProtocols, HaveOneOfHapticsAlone) {
  const StudyProtocol protocol = load(findProtocol("friction-quest").text);
  const StudyBlock& block = protocol.blocks.at(0);
  EXPECT_EQ(block.task, TaskKind::kTwoInterval);
  EXPECT_EQ(block.procedure, ProcedureKind::kQuestPlus);
  EXPECT_FALSE(block.visual);
  EXPECT_GT(block.catch_trials, 0);
  EXPECT_EQ(block.questionnaire.size(), 6U);
}

/// Tasks whose answer lies below the surface: with vision, without, and with vision that is late.
TEST(ShippedProtocols, HaveTasksThatAHandAloneCanTell) {
  for (const char* name : {"buried-stone", "firm-ground"}) {
    const StudyProtocol protocol = load(findProtocol(name).text);
    ASSERT_EQ(protocol.blocks.size(), 3U) << name;
    EXPECT_TRUE(protocol.blocks[0].visual && protocol.blocks[0].visual_delay_s == 0) << name;
    EXPECT_FALSE(protocol.blocks[1].visual) << name;
    EXPECT_EQ(protocol.blocks[2].visual_delay_s, 1) << name;
    for (const StudyBlock& block : protocol.blocks) {
      EXPECT_EQ(block.task, TaskKind::kTwoInterval) << name;
      EXPECT_EQ(values(block.levels), values(protocol.blocks[0].levels)) << name;
      EXPECT_EQ(block.reference.value, protocol.blocks[0].reference.value) << name;
      EXPECT_GT(block.reference.value, 0) << name << ": study plan takes ratios";
      EXPECT_EQ(block.procedure, ProcedureKind::kConstant) << name;
    }
  }
}

TEST(ShippedProtocols, LayTheStoneUnderTheFloorWhereThereIsNone) {
  const StudyProtocol protocol = load(findProtocol("buried-stone").text);
  const StudyBlock& block = protocol.blocks[0];
  const auto top_m = [&](const Stimulus& stimulus) {
    const PlacedStone stone = sceneOf(protocol, block, stimulus).bed.stones.placed.at(0);
    return stone.depth_m - stone.size_m / 2;
  };
  EXPECT_GT(top_m(block.reference), protocol.scene.bed.depth_m);
  for (const Stimulus& level : block.levels) {
    EXPECT_GT(top_m(level), 0) << "it would be seen";
    EXPECT_NEAR(protocol.scene.bed.depth_m / top_m(level), level.value, 0.01);
  }
}

TEST(ShippedProtocols, LayFirmGroundAsDeepAsTheAxisSays) {
  const StudyProtocol protocol = load(findProtocol("firm-ground").text);
  const StudyBlock& block = protocol.blocks[0];
  for (const Stimulus& level : block.levels) {
    const PlacedStone ground = sceneOf(protocol, block, level).bed.stones.placed.at(0);
    EXPECT_NEAR(1e3 * (ground.depth_m - ground.spheres.front().radius_m), level.value, 1e-9);
  }
}

TEST(ShippedProtocols, AreListedWhenAnotherIsAskedFor) {
  try {
    (void)findProtocol("papr");
    FAIL() << "no error";
  } catch (const InvalidParameter& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("'papr'"), HasSubstr("icra2021-gravity")));
  }
}

// --- what can be varied
// -----------------------------------------------------------------------------------------------

TEST(Protocol, IsNotForParticipantsWhileItsConsentHasBracketsToBeFilledIn) {
  const auto refused = [](const std::string& consent) -> std::string {
    StudyProtocol protocol;
    protocol.consent = consent;
    try {
      requireFilledIn(protocol);
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refused("It takes [DURATION, for example 45 minutes]. [NAME]"),
              AllOf(HasSubstr("consent = [DURATION, for example 45 minutes]"), HasSubstr("filled in")));
  EXPECT_THAT(refused("As in [1], array[i], [unfinished and [E-MAIL]."), HasSubstr("[E-MAIL]"));
  EXPECT_EQ(refused(""), "");
  EXPECT_EQ(refused("It takes 45 minutes [1]. [see the leaflet]"), "");
  for (const std::string_view name : protocolNames()) {
    const ProtocolText text = findProtocol(name);
    EXPECT_THROW(requireFilledIn(loadProtocolText(text.text, text.name)), InvalidParameter) << name;
  }
}

TEST(Protocol, SortsLevelsByTheirValues) {
  const StudyProtocol protocol =
      load(kTitle + kNames + "varies = 'friction_angle_deg'\nreference = 40\nlevels = [45, 30.5]\n");
  const StudyBlock& block = protocol.blocks[0];
  EXPECT_THAT(names(block.levels), ElementsAre("30.5", "45"));
  EXPECT_EQ(block.axis_label, "friction angle (°)");
  const SceneFile steep = sceneOf(protocol, block, block.levels[1]);
  EXPECT_NEAR(steep.bed.soil.mu_hat * std::sqrt(6), 1.0, 1e-3);  // tan 45 deg; mu_hat = mu / sqrt(6)
}

TEST(Protocol, VariesTheTangentOfTheFrictionAngle) {
  const StudyProtocol protocol =
      load(kTitle + kNames + "varies = 'friction_coefficient'\nreference = 0.835\nlevels = [0.6, 1]\n");
  const StudyBlock& block = protocol.blocks[0];
  EXPECT_THAT(values(block.levels), ElementsAre(0.6, 1));
  EXPECT_EQ(block.axis_label, "friction coefficient, tan φ");
  const SceneFile steep = sceneOf(protocol, block, block.levels[1]);
  EXPECT_NEAR(steep.bed.soil.mu_hat * std::sqrt(6), 1.0, 1e-3);  // mu_hat = mu / sqrt(6)
}

TEST(Protocol, HasEasyStimuliOfItsOwnForPracticeAndCatchTrials) {
  const StudyBlock block = load(kTitle + kNames + kFriction +
                                "practice_trials = 4\npractice_levels = ['P1', 'P5']\npractice_criterion = 0.75\n"
                                "practice_rounds = 3\ncatch_trials = 2\ncatch_levels = 'P2'\ncatch_criterion = 0.8\n"
                                "between_intervals_s = 0.5\nbetween_trials_s = 1\n")
                               .blocks[0];
  EXPECT_THAT(names(block.practice_levels), ElementsAre("P1", "P5"));
  EXPECT_THAT(values(block.practice_levels), ElementsAre(1.21, 0.648));
  EXPECT_THAT(names(block.catch_levels), ElementsAre("P2"));
  EXPECT_EQ(block.practice_rounds, 3);
  EXPECT_EQ(block.practice_criterion, 0.75);
  EXPECT_EQ(block.catch_criterion, 0.8);
  EXPECT_EQ(block.between_intervals_s, 0.5);
  EXPECT_EQ(block.between_trials_s, 1);
}

TEST(Protocol, SaysHowManyShallFinish) {
  EXPECT_EQ(load(kTitle + kNames + kFriction).planned_participants, 0);
  EXPECT_EQ(load("participants = 12\n" + kTitle + kNames + kFriction).planned_participants, 12);
}

TEST(Protocol, GivesCatchTrialsTheValuesOfTheirLevels) {
  const StudyBlock block = load(kTitle + kNames + kFriction +
                                "values = [30, 10]\nreference_value = 20\ncatch_trials = 2\ncatch_levels = ['P6']\n")
                               .blocks[0];
  EXPECT_THAT(values(block.catch_levels), ElementsAre(10));
}

TEST(Protocol, ChoosesTheAsymptotesOfQuestPlus) {
  const auto options = [](const std::string& design) {
    return load(kTitle + kNames + kFriction + "procedure = 'quest+'\n[block.quest_plus]\ndesign = '" + design + "'\n")
        .blocks[0]
        .quest_plus;
  };
  EXPECT_EQ(options("equal-asymptote").design, Design::kEqualAsymptote);
  EXPECT_EQ(options("yesno").design, Design::kYesNo);
  EXPECT_EQ(options("2afc").design, Design::kForcedChoice);
  EXPECT_EQ(options("4afc").alternatives, 4);
}

TEST(Protocol, VariesSoilsByNameOverValuesOfItsOwn) {
  const StudyProtocol protocol = load(kTitle + kNames +
                                      "varies = 'soil'\nreference = 'lms-1'\nreference_value = 2\naxis_label = 'rank'\n"
                                      "levels = ['jsc-1a', 'dry-sand']\nvalues = [3, 1]\n");
  const StudyBlock& block = protocol.blocks[0];
  EXPECT_THAT(names(block.levels), ElementsAre("dry-sand", "jsc-1a"));
  EXPECT_EQ(block.reference.value, 2);
  EXPECT_EQ(sceneOf(protocol, block, block.levels[0]).soil_name, "dry-sand");
}

TEST(Protocol, ChangesTheSceneOfABlock) {
  const StudyProtocol protocol = load(kTitle + kNames +
                                      "varies = 'contact_friction'\nreference = 0.5\nlevels = [0.25, "
                                      "1]\n[block.scene]\nsoil = 'lms-1'\nbody = 'Earth'\n");
  const SceneFile scene = sceneOf(protocol, protocol.blocks[0], protocol.blocks[0].levels[0]);
  EXPECT_EQ(scene.bed.soil.contact_friction, 0.25);
  EXPECT_EQ(scene.body, "Earth");
}

TEST(Protocol, ReadsTheKeyAndWordsOfEarlierVersionsForTheFrictionModel) {
  const StudyProtocol protocol =
      load(kTitle + kNames +
           "varies = 'body'\nreference = 'Moon'\nlevels = ['Mars', 'Ceres']\n[block.scene]\nfriction = 'paper'\n");
  EXPECT_EQ(protocol.blocks[0].scene.friction, FrictionModel::kIcra2021);
}

TEST(Protocol, VariesNumbersOfTheScene) {
  const auto scene = [](const std::string& varied, const char* scene_name) {
    const StudyProtocol protocol = load(kTitle + "scene = '" + scene_name + "'\n" + kNames + varied);
    EXPECT_EQ(names(protocol.blocks[0].levels), (std::vector<std::string>{"30", "50"}));
    return sceneOf(protocol, protocol.blocks[0], protocol.blocks[0].levels[1]);
  };
  const std::string numbers = "reference = 40\nlevels = [50, 30]\n";
  EXPECT_EQ(scene("varies = 'soil_depth_mm'\n" + numbers, "buried-stone").bed.depth_m, 0.05);
  EXPECT_EQ(scene("varies = 'stone_size_mm'\n" + numbers, "buried-stone").bed.stones.placed[0].size_m, 0.05);
  EXPECT_EQ(scene("varies = 'stone_depth_mm'\n" + numbers, "firm-ground").bed.stones.placed[0].depth_m, 0.05);
  EXPECT_EQ(scene("varies = 'gravity_m_s2'\n" + numbers, "icra2021").bed.gravity_m_s2, Vec3(0, 0, -50));
  EXPECT_EQ(scene("varies = 'soil_depth_mm'\n" + numbers + "[block.scene]\nstone_size_mm = 12\n", "buried-stone")
                .bed.stones.placed[0]
                .size_m,
            0.012);
}

TEST(Protocol, ShowsThePictureLateWhereItSaysSo) {
  EXPECT_EQ(load(kTitle + kNames + kFriction).blocks[0].visual_delay_s, 0);
  EXPECT_EQ(load(kTitle + kNames + kFriction + "visual_delay_s = 0.4\n").blocks[0].visual_delay_s, 0.4);
}

TEST(Protocol, TakesItsSceneFromBesideIt) {
  const fs::path folder = fs::path(testing::TempDir()) / fmt::format("haptolith_protocol_{}", getpid());
  fs::create_directories(folder);
  std::ofstream(folder / "scene.toml") << "[gravity]\nbody = 'Earth'\n";
  std::ofstream(folder / "p.toml") << kTitle << "scene = 'scene.toml'\n" << kNames << kFriction;
  EXPECT_EQ(loadProtocol(folder / "p.toml").scene.body, "Earth");
  fs::remove(folder / "scene.toml");
  EXPECT_THROW((void)loadProtocol(folder / "p.toml"), InvalidParameter);
  fs::remove_all(folder);
}

TEST(Protocol, ShowsTheFarthestLevelInCatchTrials) {
  EXPECT_EQ(farthestLevel(load(findProtocol("icra2021-friction").text).blocks[0]), 4U);  // P1
  // Ceres is six times less than the Moon, Earth six times more; over the logarithm Earth is a little farther.
  StudyBlock gravity = load(findProtocol("icra2021-gravity").text).blocks[0];
  EXPECT_EQ(gravity.levels[farthestLevel(gravity)].name, "Earth");
  gravity.levels[0].value = 0.1;
  EXPECT_EQ(gravity.levels[farthestLevel(gravity)].name, "Ceres");
  gravity.log_axis = false;
  EXPECT_EQ(gravity.levels[farthestLevel(gravity)].name, "Earth");
}

TEST(Protocol, AsksForms) {
  const StudyProtocol protocol =
      load(kTitle +
           "questionnaire = 'nasa-tlx'\n[[demographics]]\nkey = 'hand'\nlabel = 'Hand?'\nkind = 'choice'\n"
           "choices = ['left', 'right']\nrequired = true\n" +
           kNames + kFriction + "[[block.item]]\nkey = 'how'\nlabel = 'How?'\npersonal = true\n");
  ASSERT_EQ(protocol.demographics.size(), 1U);
  EXPECT_THAT(protocol.demographics[0].choices, ElementsAre("left", "right"));
  EXPECT_TRUE(protocol.demographics[0].required);
  EXPECT_EQ(protocol.questionnaire.size(), 6U);
  EXPECT_EQ(protocol.questionnaire[5].key, "tlx_frustration");
  ASSERT_EQ(protocol.blocks[0].questionnaire.size(), 1U);
  EXPECT_TRUE(protocol.blocks[0].questionnaire[0].personal);
}

// --- what is refused
// --------------------------------------------------------------------------------------------------

struct Wrong {
  std::string what, text, message;
};

std::ostream& operator<<(std::ostream& out, const Wrong& wrong) {
  return out << wrong.what;
}

class WrongProtocol : public testing::TestWithParam<Wrong> {};

TEST_P(WrongProtocol, IsRefusedWithItsLine) {
  const std::string error = errorOf(GetParam().text);
  EXPECT_THAT(error, StartsWith("x.toml:"));
  EXPECT_THAT(error, HasSubstr(GetParam().message));
}

const std::string kBlock = kTitle + kNames + kFriction;

INSTANTIATE_TEST_SUITE_P(
    Of, WrongProtocol,
    testing::Values(
        Wrong{"NoBlock", kTitle, "block is missing"}, Wrong{"NoTitle", kNames + kFriction, "title is missing"},
        Wrong{"AnUnknownKey", "titel = 'x'\n" + kNames, "x.toml:1: titel is not known; did you mean title?"},
        Wrong{"AnUnknownKeyOfABlock", kBlock + "repeat = 4\n",
              "9: [[block]] repeat is not known; did you mean [[block]] repeats?"},
        Wrong{"AMissingLevel", kTitle + kNames + "varies = 'preset'\nreference = 'P3'\n",
              ":2: [[block]] levels is missing"},
        Wrong{"OneLevel", kTitle + kNames + "varies = 'preset'\nreference = 'P3'\nlevels = ['P1']\n",
              ":8: [[block]] levels = [ 'P1' ] is not valid: must be two or more"},
        Wrong{"NoLevels", kTitle + kNames + "varies = 'preset'\nreference = 'P3'\nlevels = []\n", "two or more"},
        Wrong{"ALevelTwice", kTitle + kNames + "varies = 'preset'\nreference = 'P3'\nlevels = ['P1', 'P6', 'P1']\n",
              "P1 occurs twice"},
        Wrong{"ALevelThatIsNone", kTitle + kNames + "varies = 'preset'\nreference = 'P3'\nlevels = ['P1', 'P9']\n",
              "'P9' is not: one of P1, P2"},
        Wrong{"ANumberForAName", kTitle + kNames + "varies = 'body'\nreference = 'Moon'\nlevels = ['Mars', 9.8]\n",
              "'9.8' is not: one of Ceres"},
        Wrong{"ANameForANumber", kTitle + kNames + "varies = 'cohesion_pa'\nreference = 900\nlevels = [500, 'much']\n",
              "numbers; 'much' is not"},
        Wrong{"AReferenceOutsideTheLevels",
              kTitle + kNames + "varies = 'preset'\nreference = 'P6'\nlevels = ['P1', 'P2']\n",
              ":7: [[block]] reference = 'P6' is not valid: must be between the levels, 1 to 1.21; it is at 0.6"},
        Wrong{"TwoReferences", kTitle + kNames + "varies = 'preset'\nreference = ['P3', 'P4']\nlevels = ['P1', 'P2']\n",
              "one name or number"},
        Wrong{"ValuesOfOtherLength", kBlock + "values = [1]\nreference_value = 2\n",
              "as many numbers as there are levels, 2"},
        Wrong{"ValuesWithoutTheReferences", kBlock + "values = [3, 1]\n", "reference_value"},
        Wrong{"SoilsWithoutValues",
              kTitle + kNames +
                  "varies = 'soil'\nreference = 'lms-1'\nreference_value = 2\nlevels = ['jsc-1a', 'dry-sand']\n",
              "values"},
        Wrong{"TheSameValueTwice", kBlock + "values = [1, 1]\nreference_value = 2\n", "are both 1"},
        Wrong{"ALogarithmOfNothing", kBlock + "values = [3, 0]\nreference_value = 2\nlog_axis = true\n",
              ":11: [[block]] log_axis"},
        Wrong{"ASliderThatTheSoilHasNot",
              kTitle + kNames + "varies = 'contact_friction'\nreference = 0.5\nlevels = [0.2, 1]\n",
              "friction_angle_deg"},
        Wrong{"ALevelOutOfRange",
              kTitle + kNames + "varies = 'friction_angle_deg'\nreference = 40\nlevels = [30, 95]\n", "95"},
        Wrong{"AnswersThatAreTheSame",
              kTitle + "[[block]]\nname = 'a'\nquestion = 'q'\nanswers = ['more', 'more']\n" + kFriction,
              "two different texts"},
        Wrong{"ANameThatIsNoFileName",
              kTitle + "[[block]]\nname = 'a/b'\nquestion = 'q'\nanswers = ['l', 'm']\n" + kFriction,
              "[[block]] name = 'a/b'"},
        Wrong{"TwoBlocksOfOneName", kBlock + kNames + kFriction, ":10: [[block]] name"},
        Wrong{"ABlockOfAFormsName",
              kTitle + "[[block]]\nname = 'demographics'\nquestion = 'q'\nanswers = ['l', 'm']\n" + kFriction,
              "a form of every study has it"},
        Wrong{"RepeatsOfAnAdaptiveBlock", kBlock + "procedure = 'quest+'\nrepeats = 3\n",
              "the procedure ends automatically"},
        Wrong{"AStaircaseThatIsNone", kBlock + "[block.staircase]\ndown = 3\n", "the procedure is not a staircase"},
        Wrong{"AStaircaseThatCannotBe",
              kBlock + "procedure = 'staircase'\n[block.staircase]\nreversals = 2\nuncounted_reversals = 5\n",
              "procedure"},
        Wrong{"ACriterionWithoutPractice", kBlock + "practice_criterion = 0.8\n", "there are no practice_trials"},
        Wrong{"RoundsWithoutACriterion", kBlock + "practice_trials = 2\npractice_rounds = 2\n",
              "there is no practice_criterion"},
        Wrong{"ACriterionWithoutCatchTrials", kBlock + "catch_criterion = 0.8\n", "there are no catch_trials"},
        Wrong{"ACatchLevelThatIsTheReference", kBlock + "catch_trials = 2\ncatch_levels = ['P1', 'P3']\n",
              "another than the reference"},
        Wrong{"ACatchLevelWithoutAPlace",
              kBlock + "values = [3, 1]\nreference_value = 2\ncatch_trials = 2\ncatch_levels = ['P2']\n",
              "one of the levels, because the levels have `values`"},
        Wrong{"ADesignThatIsNone", kBlock + "procedure = 'quest+'\n[block.quest_plus]\ndesign = '1afc'\n",
              "2afc, 3afc, ... or 100afc"},
        Wrong{"AVisualDelayOutOfRange", kBlock + "visual_delay_s = 5.5\n",
              "visual_delay_s = 5.5 is not valid: must be 0 to 5"},
        Wrong{"AVisualDelayOfNothing", kBlock + "visual = false\nvisual_delay_s = 1\n",
              "visual_delay_s = 1 is not valid: must be left out: with `visual = false` the scene is not shown"},
        Wrong{"AStoneThatIsNotThere",
              kTitle + kNames + "varies = 'stone_depth_mm'\nreference = 20\nlevels = [10, 30]\n",
              "the scene has no [[stone]]"},
        Wrong{"ADepthOfACountedBed", kTitle + kNames + "varies = 'soil_depth_mm'\nreference = 20\nlevels = [10, 30]\n",
              "filled up to a depth"},
        Wrong{"AGravityOutOfRange", kTitle + kNames + "varies = 'gravity_m_s2'\nreference = 20\nlevels = [10, 3000]\n",
              "3000"},
        Wrong{"ASceneThatIsNone", kTitle + "scene = 'buried-ston'\n" + kNames + kFriction, "buried-ston"},
        Wrong{"TooManyRepeats", kBlock + "repeats = 100000\n", "1 to 1000"},
        Wrong{"ABlockThatIsNoTable", kTitle + "block = 3\n", "tables, each under [[block]]"},
        Wrong{"TwoSoils", kBlock + "[block.scene]\npreset = 'P1'\nsoil = 'lms-1'\n", "cannot both be given"},
        Wrong{"AChoiceWithoutChoices",
              kTitle + "[[demographics]]\nkey = 'a'\nlabel = 'A'\nkind = 'choice'\n" + kNames + kFriction,
              "[[demographics]] choices"},
        Wrong{"AScaleWithoutLength", kTitle + "[[item]]\nkey = 'a'\nlabel = 'A'\nkind = 'scale'\n" + kNames + kFriction,
              "[[item]] high"},
        Wrong{"TwoItemsOfOneKey",
              kBlock + "[[block.item]]\nkey = 'a'\nlabel = 'A'\n[[block.item]]\nkey = 'a'\nlabel = 'B'\n",
              ":13: [[block.item]] key"},
        Wrong{"NoToml", "title = \n", "not TOML"}),
    [](const auto& of) { return of.param.what; });

// --- the document
// -----------------------------------------------------------------------------------------------------

std::string pagesOfKeys() {
  return readSource("docs/reference/protocol-keys.md") + readSource("docs/reference/protocol-tables.md");
}

template <class Key>
void expectDocumented(std::span<const Key> keys, const std::string& top, std::string_view within = "") {
  const std::string document = pagesOfKeys();
  for (const Key& key : keys) {
    const std::string heading = key.table.empty() ? top : fmt::format("\n## [{}{}]\n", within, key.table);
    const std::size_t section = document.find(heading);
    ASSERT_NE(section, std::string::npos) << "no section " << heading;
    const std::string text = document.substr(section, document.find("\n#", section + 1) - section);
    EXPECT_THAT(text, HasSubstr(fmt::format("| `{}` | {} | {} |\n", key.name, validText(key), key.meaning)));
  }
}

TEST(ProtocolKeys, AreAllInTheDocument) {
  expectDocumented(protocolKeys(), "\n## At the top\n");
  expectDocumented(groupKeys(), "\n## [[groups]]\n");
  expectDocumented(blockKeys(), "\n## [[block]]\n", "block.");
  expectDocumented(itemKeys(), "\n## [[demographics]], [[block.item]], [[item]]\n");
}

TEST(ProtocolKeys, TheDocumentHasNoOthers) {
  const std::string document = pagesOfKeys();
  std::size_t rows = 0;
  for (std::size_t at = document.find("\n| `"); at != std::string::npos; at = document.find("\n| `", at + 1)) {
    ++rows;
  }
  EXPECT_EQ(rows, protocolKeys().size() + groupKeys().size() + blockKeys().size() + itemKeys().size());
}

}  // namespace
}  // namespace haptolith

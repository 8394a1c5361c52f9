#include "haptolith/viewer/command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <class Wanted>
Wanted parsed(std::string_view text) {
  const ClientMessage message = parseClientMessage(text);
  EXPECT_EQ(message.refused, "") << text;
  if (!message.command || !std::holds_alternative<Wanted>(*message.command)) {
    ADD_FAILURE() << text;
    return {};
  }
  return std::get<Wanted>(*message.command);
}

std::string refused(std::string_view text) {
  const ClientMessage message = parseClientMessage(text);
  EXPECT_FALSE(message.command) << text;
  EXPECT_NE(message.refused, "") << text;
  return message.refused;
}

TEST(Command, EveryCommandOfTheProtocolIsUnderstood) {
  const auto hold = parsed<command::Hold>(R"({"do": "hold", "pose": [0.1, 0.2, 0.3, 1, 0, 0, 0]})");
  EXPECT_EQ(hold.scene_T_tool.position_m, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(hold.scene_T_tool.orientation.w(), 1);
  EXPECT_EQ(hold.tool, std::nullopt);
  EXPECT_EQ(parsed<command::Hold>(R"({"do": "hold", "pose": [0, 0, 0, 1, 0, 0, 0], "tool": "left"})").tool, "left");
  EXPECT_EQ(parsed<command::Release>(R"({"do": "release"})").tool, std::nullopt);
  EXPECT_EQ(parsed<command::Release>(R"({"do": "release", "tool": "left"})").tool, "left");
  EXPECT_EQ(parsed<command::Play>(R"({"do": "play", "motion": "stir", "tool": "left"})").tool, "left");
  EXPECT_EQ(parsed<command::Play>(R"({"do": "play", "motion": "stir"})").motion, HandMotion::kStir);
  const auto file = parsed<command::ToolFile>(
      R"({"do": "tool_file", "upload": 7, "name": "Ålesund.OBJ", "unit_mm": 25.4, "sheet_thickness_mm": 1.5})");
  EXPECT_EQ(file.upload, 7U);
  EXPECT_EQ(file.source.name, "Ålesund.OBJ");
  EXPECT_EQ(file.source.format, MeshFormat::kObj);
  EXPECT_EQ(file.source.unit_m, 0.0254);
  EXPECT_EQ(file.source.sheet_thickness_m, 0.0015);
  EXPECT_EQ(parsed<command::ToolFile>(R"({"do": "tool_file", "upload": 0, "name": "a.stl"})").source.unit_m, 0.001);
  parsed<command::Reset>(R"({"do": "reset"})");
  parsed<command::Level>(R"({"do": "level"})");
  parsed<command::Coarser>(R"({"do": "coarser"})");
  parsed<command::Undo>(R"({"do": "undo"})");
  parsed<command::Pause>(R"({"do": "pause"})");
  parsed<command::Resume>(R"({"do": "resume"})");
  EXPECT_EQ(parsed<command::Step>(R"({"do": "step", "ticks": 10})").ticks, 10);
  EXPECT_EQ(parsed<command::Speed>(R"({"do": "speed", "factor": 0.1})").factor, 0.1);
  EXPECT_TRUE(parsed<command::Record>(R"({"do": "record", "on": true})").on);
  EXPECT_TRUE(parsed<command::Colour>(R"({"do": "colour", "by": "force"})").by_force);
  EXPECT_FALSE(parsed<command::Colour>(R"({"do": "colour", "by": "depth"})").by_force);
}

TEST(Command, ThePreviousWordsForFrictionAreStillRead) {
  EXPECT_EQ(parsed<command::Change>(R"({"do": "scene", "friction": "pairwise"})").change.friction,
            FrictionModel::kContact);
  EXPECT_EQ(parsed<command::Change>(R"({"do": "scene", "friction": "paper"})").change.friction,
            FrictionModel::kIcra2021);
}

TEST(Command, ThePreviousNameOfTheHandsMotionIsStillRead) {
  EXPECT_EQ(parsed<command::Play>(R"({"do": "play", "manoeuvre": "press"})").motion, HandMotion::kPress);
}

TEST(Command, AChangeOfTheSceneIsReadWhole) {
  const SceneChange change = parsed<command::Change>(
                                 R"({"do": "scene", "preset": "P1", "body": "Mars", "friction": "contact",
                                     "sliders": {"contact_friction": 0.5},
                                     "tool": {"shape": "plate", "size_mm": [50, 40, 5], "diameter_mm": 30, "thickness_mm": 4,
                                              "opening_mm": 20, "length_mm": 70}})")
                                 .change;
  EXPECT_EQ(change.preset, "P1");
  EXPECT_EQ(change.body, "Mars");
  EXPECT_EQ(change.friction, FrictionModel::kContact);
  ASSERT_EQ(change.sliders.size(), 1U);
  EXPECT_EQ(change.sliders[0], std::pair(std::string("contact_friction"), 0.5));
  EXPECT_EQ(change.tool_shape, ToolShape::kPlate);
  EXPECT_NEAR((change.tool_size_m.value() - Vec3(0.05, 0.04, 0.005)).norm(), 0, 1e-12);
  EXPECT_DOUBLE_EQ(change.tool_diameter_m.value(), 0.03);
  EXPECT_DOUBLE_EQ(change.tool_thickness_m.value(), 0.004);
  EXPECT_DOUBLE_EQ(change.tool_length_m.value(), 0.07);
  EXPECT_DOUBLE_EQ(change.tool_opening_m.value(), 0.02);
}

TEST(Command, TheIdComesBackEvenWithWhatIsRefused) {
  EXPECT_EQ(parseClientMessage(R"({"id": 7, "do": "reset"})").id, 7);
  EXPECT_EQ(parseClientMessage(R"({"id": 8, "do": "nonsense"})").id, 8);
  EXPECT_EQ(parseClientMessage(R"({"id": 9007199254740991, "do": "reset"})").id, 9007199254740991);
  EXPECT_FALSE(parseClientMessage(R"({"do": "reset"})").wants_reply);
}

TEST(Command, AnIdThatCannotBeRepeatedExactlyIsRefused) {
  for (const char* id : {"9007199254740992", "18446744073709551615", "1e300", "-1", "1.5", "\"x\"", "null", "[1]"}) {
    const std::string text = std::string(R"({"do": "reset", "id": )") + id + "}";
    const ClientMessage message = parseClientMessage(text);
    EXPECT_THAT(refused(text), HasSubstr("0 to 9007199254740991"));
    EXPECT_TRUE(message.wants_reply) << id;
    EXPECT_EQ(message.id, std::nullopt) << id;
  }
}

TEST(Command, AConfirmationIsTrueOrFalse) {
  EXPECT_FALSE(parseClientMessage(R"({"do": "reset"})").confirmed);
  EXPECT_FALSE(parseClientMessage(R"({"do": "reset", "confirmed": false})").confirmed);
  EXPECT_TRUE(parseClientMessage(R"({"do": "reset", "confirmed": true})").confirmed);
  EXPECT_THAT(refused(R"({"do": "reset", "confirmed": 1})"), HasSubstr("true or false"));
}

TEST(Command, ControlCharactersComeBackVisible) {
  EXPECT_THAT(refused(R"({"do": "scene", "soil": "a\u0000b\u001b]0;"})"),
              AllOf(HasSubstr("a\\u0000b\\u001b]0;"), HasSubstr("dry-sand")));
}

TEST(Command, WhatIsWrongIsSaid) {
  EXPECT_THAT(refused("{"), HasSubstr("not JSON"));
  EXPECT_THAT(refused("[]"), HasSubstr("a JSON object"));
  EXPECT_THAT(refused("{}"), HasSubstr("do"));
  EXPECT_THAT(refused(R"({"do": 1})"), HasSubstr("a text"));
  EXPECT_THAT(refused(R"({"do": "format"})"), HasSubstr("release"));
  EXPECT_THAT(refused(R"({"do": "reset", "also": 1})"), HasSubstr("also"));
  EXPECT_THAT(refused(R"({"do": "hold"})"), HasSubstr("pose"));
  EXPECT_THAT(refused(R"({"do": "hold", "pose": [1, 2, 3]})"), HasSubstr("7 numbers"));
  EXPECT_THAT(refused(R"({"do": "hold", "pose": [1, 2, 3, "4", 5, 6, 7]})"), HasSubstr("a number"));
  EXPECT_THAT(refused(R"({"do": "hold", "pose": [1e300, 2, 3, 4, 5, 6, 7]})"), HasSubstr("-1000 to 1000"));
  EXPECT_THAT(refused(R"({"do": "play"})"), HasSubstr("scoop"));
  EXPECT_THAT(refused(R"({"do": "play", "motion": "poses"})"),
              HasSubstr("still, press, stir, scoop, carry, shake, cut or furrows"));
  EXPECT_THAT(refused(R"({"do": "tool_file", "name": "a.stl"})"), HasSubstr("upload"));
  EXPECT_THAT(refused(R"({"do": "tool_file", "upload": -1, "name": "a.stl"})"), HasSubstr("whole number"));
  EXPECT_THAT(refused(R"({"do": "tool_file", "upload": 1, "name": "a.step"})"), HasSubstr(".glb"));
  EXPECT_THAT(refused(R"({"do": "tool_file", "upload": 1, "name": "a.stl", "unit_mm": 0})"), HasSubstr("unit_mm"));
  EXPECT_THAT(refused(R"({"do": "step", "ticks": 0})"), HasSubstr("1 to 1000"));
  EXPECT_THAT(refused(R"({"do": "step", "ticks": 1.5})"), HasSubstr("whole number"));
  EXPECT_THAT(refused(R"({"do": "speed", "factor": 2})"), HasSubstr("0.01 to 1"));
  EXPECT_THAT(refused(R"({"do": "record", "on": 1})"), HasSubstr("true or false"));
  EXPECT_THAT(refused(R"({"do": "scene", "tool": {"shape": "fork"}})"), HasSubstr("sphere"));
  EXPECT_THAT(refused(R"({"do": "scene", "tool": {"size_mm": [0, 1, 1]}})"), HasSubstr("0.01 to 10000"));
  EXPECT_THAT(refused(R"({"do": "scene", "tool": {"colour": 1}})"), HasSubstr("colour"));
  EXPECT_THAT(refused(R"({"do": "scene", "sliders": [1]})"), HasSubstr("an object"));
}

TEST(Command, WhatIsTheGuestsIsLeftToTheGuest) {
  const ClientMessage message = parseClientMessage(R"({"id": 5, "do": "study", "act": "answer", "choice": 1})");
  EXPECT_TRUE(message.for_guest);
  EXPECT_FALSE(message.command);
  EXPECT_EQ(message.refused, "");
  EXPECT_EQ(message.id, 5);
  EXPECT_FALSE(parseClientMessage(R"({"do": "reset"})").for_guest);
  EXPECT_FALSE(parseClientMessage(R"({"do": ["study"]})").for_guest);
  EXPECT_FALSE(parseClientMessage(R"(["study"])").for_guest);
}

TEST(Command, AClientCannotMakeTheProgramReadFiles) {
  EXPECT_THAT(refused(R"({"do": "scene", "soil": "/etc/passwd"})"), HasSubstr("dry-sand"));
  EXPECT_EQ(parsed<command::Change>(R"({"do": "scene", "soil": "dry-sand"})").change.soil, "dry-sand");
}

TEST(Command, ALongWrongWordComesBackShort) {
  const std::string text = R"({"do": ")" + std::string(3000, 'x') + R"("})";
  EXPECT_LT(refused(text).size(), 400U);
}

TEST(Command, WhatIsNestedDeeplyIsRefusedAndNotTakenApart) {
  const auto nested = [](int deep) { return std::string(deep, '[').append(deep, ']'); };
  EXPECT_THAT(refused(nested(8192)), HasSubstr("more than 8 deep"));
  EXPECT_THAT(refused(nested(9)), HasSubstr("more than 8 deep"));
  EXPECT_THAT(refused(nested(8)), HasSubstr("a JSON object"));
  EXPECT_THAT(refused(std::string(9, '[')), HasSubstr("more than 8 deep"));
  EXPECT_THAT(refused(R"({"do": "[[[[[[\"[[[[[[[["})"), HasSubstr("release")) << "brackets in a text are none";
}

TEST(Command, NoBytesMakeItThrow) {
  std::mt19937 random(1);
  const std::string seed = R"({"id": 3, "do": "scene", "sliders": {"a": 1e5}, "tool": {"size_mm": [1, 2, 3]}})";
  for (int i = 0; i < 20'000; ++i) {
    std::string text = seed;
    for (int k = 0; k < 3; ++k) {
      text[random() % text.size()] = static_cast<char>(random());
    }
    EXPECT_NO_THROW((void)parseClientMessage(text)) << text;
  }
  EXPECT_NO_THROW((void)parseClientMessage(std::string(16384, '[')));
}

}  // namespace
}  // namespace haptolith

#include "haptolith/device/drivers/inverse3_messages.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "haply_service.h"

namespace haptolith {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::optional<Inverse3State> stateIn(const std::string& json) {
  return parseInverse3State(json, "049D", "61A5");
}

/// A good message with one value replaced.
std::string with(const char* pointer, const nlohmann::json& value) {
  auto message = nlohmann::json::parse(HaplyService::state());
  message[nlohmann::json::json_pointer(pointer)] = value;
  return message.dump();
}

TEST(HaplyInventory, ListsDevicesAndGripsAndTellsTheDialect) {
  for (const HaplyDialect dialect : {HaplyDialect::kVector, HaplyDialect::kValues}) {
    const auto inventory = parseHaplyInventory(HaplyService::inventory(dialect));
    ASSERT_TRUE(inventory);
    EXPECT_THAT(inventory->devices, ElementsAre("049D", "0FFF"));
    EXPECT_THAT(inventory->grips, ElementsAre("61A5"));
    EXPECT_EQ(inventory->dialect, dialect);
  }
}

TEST(HaplyInventory, AnyNewsOf35TellTheDialect) {
  for (const char* news : {"basis", "mount", "preset", "filters"}) {
    const std::string json = std::string(R"({"inverse3":[{"device_id":"A","config":{")") + news + R"(":{}}}]})";
    EXPECT_EQ(parseHaplyInventory(json)->dialect, HaplyDialect::kVector) << news;
  }
  EXPECT_EQ(parseHaplyInventory(R"({"session_id":0})")->dialect, HaplyDialect::kVector);
  EXPECT_EQ(parseHaplyInventory(R"({"inverse3":[{"device_id":"A","config":{"handedness":"left"}}]})")->dialect,
            HaplyDialect::kValues);
}

TEST(HaplyInventory, LeavesOutWhatHasNoUsableId) {
  const auto inventory = parseHaplyInventory(
      R"({"inverse3":[{"device_id":5},{},{"device_id":""},null,[],{"device_id":")" + std::string(65, 'x') +
      R"("},{"device_id":"B"}],"wireless_verse_grip":{"device_id":"61A5"}})");
  ASSERT_TRUE(inventory);
  EXPECT_THAT(inventory->devices, ElementsAre("B"));
  EXPECT_THAT(inventory->grips, IsEmpty());
  EXPECT_THAT(parseHaplyInventory("{}")->devices, IsEmpty());
}

TEST(HaplyInventory, RefusesWhatIsNoJsonObject) {
  for (const char* text : {"", "{", "[]", "7", "null", "\"inverse3\"", "<html>", "{\"inverse3\":[}", "\xff\xfe"}) {
    EXPECT_FALSE(parseHaplyInventory(text)) << text;
  }
  EXPECT_FALSE(parseHaplyInventory(std::string(200'000, '['))) << "however deep";
}

TEST(Inverse3State, IsReadFromAMessage) {
  const auto state = stateIn(HaplyService::state());
  ASSERT_TRUE(state);
  EXPECT_EQ(state->position_m, Vec3(0.01, -0.12, 0.15));
  EXPECT_EQ(state->velocity_m_s, Vec3(0, 0.2, -0.3));
  ASSERT_TRUE(state->orientation);
  EXPECT_EQ(state->orientation->coeffs(), Quat(0.5, -0.5, 0.5, -0.5).coeffs());
  EXPECT_EQ(state->buttons, 0b101U);
}

TEST(Inverse3State, IsThatOfItsOwnDeviceAndGrip) {
  const std::string message = HaplyService::state();
  EXPECT_FALSE(parseInverse3State(message, "0FFF", "61A5"));
  EXPECT_FALSE(parseInverse3State(message, "", "61A5"));
  for (const char* grip : {"", "61A6"}) {
    const auto state = parseInverse3State(message, "049D", grip);
    ASSERT_TRUE(state);
    EXPECT_FALSE(state->orientation);
    EXPECT_FALSE(state->buttons);
  }
}

TEST(Inverse3State, NeedsSixSaneNumbers) {
  for (const char* place : {"/inverse3/0/state/cursor_position/x", "/inverse3/0/state/cursor_position/z",
                            "/inverse3/0/state/cursor_velocity/y"}) {
    for (const nlohmann::json& bad : {nlohmann::json(), nlohmann::json("0.1"), nlohmann::json(true),
                                      nlohmann::json::array({0.1}), nlohmann::json::object(), nlohmann::json(51.0),
                                      nlohmann::json(-1e300), nlohmann::json(18'446'744'073'709'551'615U)}) {
      EXPECT_FALSE(stateIn(with(place, bad))) << place << " " << bad;
    }
    EXPECT_TRUE(stateIn(with(place, 1))) << "a whole number is one, too";
  }
  for (const char* number : {"NaN", "Infinity", "1e999", "0.1f", "", "0x1"}) {
    EXPECT_FALSE(stateIn(HaplyService::state(number))) << number;
  }
  EXPECT_FALSE(stateIn(HaplyService::state("2.001")));
  EXPECT_TRUE(stateIn(HaplyService::state("-2")));
  for (const char* place : {"/inverse3/0/state/cursor_position", "/inverse3/0/state", "/inverse3/0", "/inverse3"}) {
    for (const nlohmann::json& bad :
         {nlohmann::json(), nlohmann::json(3), nlohmann::json::array(), nlohmann::json("")}) {
      EXPECT_FALSE(stateIn(with(place, bad))) << place;
    }
  }
}

TEST(Inverse3State, AGripThatTellsNonsenseIsAsNone) {
  for (const nlohmann::json& bad :
       {nlohmann::json(), nlohmann::json("1"), nlohmann::json(0.4), nlohmann::json(1e300)}) {
    const auto state = stateIn(with("/wireless_verse_grip/0/state/orientation/w", bad));
    ASSERT_TRUE(state) << "the arm is another device";
    EXPECT_FALSE(state->orientation) << bad;
    EXPECT_EQ(state->buttons, 0b101U);
  }
  EXPECT_EQ(stateIn(with("/wireless_verse_grip/0/state/buttons/a", 1))->buttons, 0b100U);
  EXPECT_FALSE(stateIn(with("/wireless_verse_grip/0/state/buttons", 1))->buttons);
}

TEST(Inverse3Command, IsTheServices) {
  EXPECT_EQ(
      nlohmann::json::parse(inverse3Command("049D", Vec3(0, -0.5, 1.5), HaplyDialect::kVector)),
      nlohmann::json::parse(
          R"({"inverse3":[{"device_id":"049D","commands":{"set_cursor_force":{"vector":{"x":0.0,"y":-0.5,"z":1.5}}}}]})"));
  EXPECT_EQ(
      nlohmann::json::parse(inverse3Command("a\"b", Vec3(1, 2, 3), HaplyDialect::kValues)),
      nlohmann::json::parse(
          R"({"inverse3":[{"device_id":"a\"b","commands":{"set_cursor_force":{"values":{"x":1.0,"y":2.0,"z":3.0}}}}]})"));
}

}  // namespace
}  // namespace haptolith

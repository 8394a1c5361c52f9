#include "haptolith/viewer/messages.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace haptolith {
namespace {

using Json = nlohmann::json;

TEST(Messages, AReplyRepeatsItsIdAndTheReason) {
  EXPECT_EQ(Json::parse(replyMessage(7, "")), Json::parse(R"({"type": "reply", "id": 7, "ok": true})"));
  EXPECT_EQ(Json::parse(replyMessage({}, "too late")),
            Json::parse(R"({"type": "reply", "id": null, "ok": false, "error": "too late"})"));
  EXPECT_EQ(Json::parse(replyMessage(1, "cut \xc3"))["ok"], false) << "bytes that are no UTF-8 break no message";
}

TEST(Messages, NamelessOnesNameNoSoilWorldPresetOrFile) {
  const Board::Texts hello = helloMessages("1.2.3", true, false);
  const Json named = Json::parse(hello.whole);
  Json nameless = Json::parse(hello.nameless);
  EXPECT_GT(named["soils"].size(), 0U);
  EXPECT_EQ(named["version"], "1.2.3");
  for (const char* names : {"presets", "soils", "bodies", "frictions"}) {
    EXPECT_TRUE(nameless[names].empty()) << names;
    nameless[names] = named[names];
  }
  EXPECT_EQ(nameless, named) << "all else is the same";

  const Session session(SceneFile(), false, SettleProgress{});
  const Board::Texts status =
      statusMessages(session, {.recording = "secret.h5", .recorded = "/home/somebody/clay-on-mars.h5"});
  EXPECT_EQ(Json::parse(status.whole)["recorded"],
            Json::parse(R"({"file": "clay-on-mars.h5", "folder": "/home/somebody"})"));
  for (const char* name : {"secret", "clay", "somebody"}) {
    EXPECT_NE(status.whole.find(name), std::string::npos) << name;
    EXPECT_EQ(status.nameless.find(name), std::string::npos) << name;
  }
}

TEST(Messages, TheSiteOfARobotIsInTenthsOfMillimetresWithNullForTheUnknown) {
  const Session session(SceneFile(), false, SettleProgress{});
  RobotShown robot;
  robot.state = "following";
  robot.learned = {.friction_angle_deg = {30, 35, 40}, .cohesion_pa = {0, 100, 500}};
  robot.site = {.x_m = -0.1,
                .y_m = 0.2,
                .cell_m = 0.005,
                .columns = 2,
                .rows = 1,
                .height_m = {-0.01234, std::numeric_limits<double>::quiet_NaN()}};
  const Json shown = Json::parse(statusMessages(session, {.robot = &robot}).whole)["robot"];
  EXPECT_EQ(shown["reason"], nullptr);
  EXPECT_EQ(shown["learned"]["friction_angle_deg"], Json({30.0, 35.0, 40.0}));
  EXPECT_EQ(shown["site"]["heights_mm"], Json::parse("[-12.3, null]"));
  EXPECT_EQ(shown["site"]["corner_m"], Json({-0.1, 0.2}));
  EXPECT_EQ(Json::parse(statusMessages(session, {}).whole)["robot"], nullptr);
}

}  // namespace
}  // namespace haptolith

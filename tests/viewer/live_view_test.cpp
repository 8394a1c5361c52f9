#include "haptolith/viewer/live_view.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "haptolith/core/base64.h"
#include "haptolith/core/error.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/soil/presets.h"
#include "haptolith/tool/tool_mesh.h"
#include "haptolith/viewer/messages.h"

#include "ws_client.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

/// A guest that greets, and permits holding the tool until it is changed, but nothing else.
struct TalkingExtension {
  LiveView* view = nullptr;
  std::atomic<std::uint32_t> left{0};
  std::atomic<bool> may_hold{true};

  std::string handleMessages(std::uint32_t client, const Json& message) {
    if (message["act"] == "throw") {
      throw InvalidParameter("act", "throw", "kind");
    }
    if (message["act"] == "ask too much") {
      throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again), "no thread");
    }
    if (message["act"] == "let go") {
      view->releaseTools();
    }
    if (message["act"] == "hold no more") {
      may_hold = false;
    }
    if (message["act"] == "join") {
      view->send(client, Json{{"type", "study"}, {"welcome", client}}.dump());
    }
    return message["act"] == "nonsense" ? "there is no such act" : "";
  }

  LiveView::Extension functions() {
    return {.handle = [this](std::uint32_t client,
                             std::string_view text) { return handleMessages(client, Json::parse(text)); },
            .joined = {},
            .left = [this](std::uint32_t client) { left = client; },
            .refuse = [this](std::uint32_t, const Command& asked) -> std::string {
              if (std::holds_alternative<command::Hold>(asked)) {
                return may_hold ? "" : "not now";
              }
              return std::holds_alternative<command::Release>(asked) ? "" : "a study is running";
            }};
  }
};

/// A running session with its view, driven by a thread as `haptolith run` does.
class LiveViewTest : public testing::Test {
 protected:
  explicit LiveViewTest(bool has_extension = false, LiveView::Clients clients = LiveView::Clients::kCommand,
                        std::unique_ptr<HapticDevice> device = nullptr, SceneFile scene_file = {}) {
    scene_file.hand.motion = HandMotion::kStill;
    scene_file.loop.real_time = false;
    session_ = std::make_unique<Session>(scene_file, false, SettleProgress{}, std::move(device));
    view_ = std::make_unique<LiveView>(*session_, WebServerOptions{.port = 0, .takes_uploads = true}, "test",
                                       LiveView::Recorder{.start =
                                                              [this] {
                                                                startThread();
                                                                recording_ = true;
                                                              },
                                                          .stop = [this] { recording_ = false; },
                                                          .name = [this] { return recording_ ? "tape.csv" : ""; }},
                                       has_extension ? extension_.functions() : LiveView::Extension{}, clients);
    extension_.view = view_.get();
    const std::string url = view_->url();
    port_ = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
    session_->start(stop_);
    thread_ = std::thread([this] {
      while (!session_->done()) {
        view_->handleMessages();
        const bool changed = session_->poll();
        if (has_robot_) {
          view_->setRobot(robot_);
        }
        view_->show(session_->update(), changed);
        std::this_thread::sleep_for(1ms);
      }
    });
  }
  ~LiveViewTest() override {
    stop_ = true;
    thread_.join();
  }

  static void startThread() {
    std::thread([] {}).join();
  }

  static Json ask(WsClient& client, Json command) {
    command["id"] = 1;
    client.send(command.dump());
    return client.receive("reply").value_or(Json());
  }

  /// The next message of a type for which something is so.
  template <class IsSo>
  static testing::AssertionResult until(WsClient& client, const std::string& type, IsSo is_so) {
    while (const std::optional<Json> message = client.receive(type)) {
      if (is_so(*message)) {
        return testing::AssertionSuccess();
      }
    }
    return testing::AssertionFailure() << "the connection ended first";
  }

  std::atomic<bool> stop_{false}, recording_{false}, has_robot_{false};
  RobotShown robot_;  ///< before has_robot_ is set
  TalkingExtension extension_;
  std::unique_ptr<Session> session_;
  std::unique_ptr<LiveView> view_;
  std::thread thread_;
  std::uint16_t port_ = 0;
};

TEST(SceneMessage, TellsHowManyGrainsThereAreOfEachSize) {
  SceneFile scene_file;
  scene_file.bed.soil.friction = FrictionModel::kContact;
  scene_file.bed.width_m = scene_file.bed.length_m = 0.1;
  scene_file.bed.start = BedStart::kRain;
  scene_file.bed.particles = 100;
  scene_file.bed.grading = {
      .fine_radius_m = 0.0035, .fine_width_m = 0.02, .fine_length_m = 0.02, .fine_depth_m = 0.015};
  const Session session(scene_file, false, SettleProgress{});
  const Json scene = Json::parse(sceneMessages(session, {Vec3(-1, -1, -1), Vec3(1, 1, 1)}).whole);
  const Json& grains = scene["grains"];
  ASSERT_EQ(grains.size(), 2U);
  EXPECT_EQ(scene["radius_m"], 0.007);
  EXPECT_EQ(grains[0]["radius_m"], 0.007);
  EXPECT_EQ(grains[1]["radius_m"], 0.0035);
  EXPECT_GT(grains[1]["count"], 10);
  EXPECT_EQ(grains[0]["count"].get<int>() + grains[1]["count"].get<int>(), scene["particles"]);
  for (std::size_t i = 0; const Float4& p : session.snapshot().position) {
    EXPECT_EQ(p.w < -0.001, i >= grains[0]["count"].get<std::size_t>()) << i;
    ++i;
  }
}

TEST(SceneMessage, TellsOfANamedSoilWhatWasMeasuredAndNotItsParameters) {
  const auto soil_of = [](const SceneFile& wanted) {
    const SceneLookedAt shown{.scene_file = wanted, .soil = wanted.bed.soil, .grains = {}, .low_m = {}, .high_m = {}};
    return Json::parse(sceneMessages(shown, {Vec3(-1, -1, -1), Vec3(1, 1, 1)}).whole)["soil"];
  };
  SceneFile scene_file = findSceneFile("regolith");
  const SoilTarget measured = findSoil(scene_file.soil_name).target;
  EXPECT_EQ(soil_of(scene_file)["bulk_density_kg_m3"], measured.bulk_density_kg_m3);
  EXPECT_EQ(soil_of(scene_file)["friction_angle_deg"], measured.friction_angle_deg);
  scene_file.bed.soil.contact_friction *= 1.5;
  EXPECT_EQ(soil_of(scene_file)["bulk_density_kg_m3"], measured.bulk_density_kg_m3) << "it lies there as before";
  EXPECT_EQ(soil_of(scene_file)["friction_angle_deg"], nullptr);
  scene_file.bed.soil.rho0_kg_m3 *= 1.1;
  EXPECT_EQ(soil_of(scene_file)["bulk_density_kg_m3"], nullptr) << "nobody has measured this one";
  EXPECT_NEAR(soil_of(SceneFile{})["bulk_density_kg_m3"].get<double>(), 1501, 20) << "Table I, not rho0";
}

TEST(SceneMessage, HasTheMeshOfAToolWhateverTheShapeIsNow) {
  SceneFile scene_file = sceneFileFromText("[tool]\nname = 'rake'\n", "x.toml");
  const auto tool_of = [](const SceneFile& shown) {
    const Session session(shown, false, SettleProgress{});
    return Json::parse(sceneMessages(session, {Vec3(-1, -1, -1), Vec3(1, 1, 1)}).whole)["tool"];
  };
  const Json rake = tool_of(scene_file);
  EXPECT_EQ(rake["shape"], "mesh");
  EXPECT_EQ(rake["mesh"]["name"], "rake");
  const TriangleMesh& surface = scene_file.tool.mesh->surface;
  const std::string points = fromBase64(rake["mesh"]["points_base64"].get<std::string>()).value();
  const std::string triangles = fromBase64(rake["mesh"]["triangles_base64"].get<std::string>()).value();
  ASSERT_EQ(points.size(), 12 * surface.points_m.size());
  ASSERT_EQ(triangles.size(), 12 * surface.triangles.size());
  float first_m = 0;
  std::memcpy(&first_m, points.data(), sizeof first_m);
  EXPECT_EQ(first_m, static_cast<float>(surface.points_m.front().x()));
  scene_file.tool.shape = ToolShape::kSphere;
  EXPECT_EQ(tool_of(scene_file)["mesh"], rake["mesh"]);
  EXPECT_EQ(tool_of(SceneFile())["mesh"], nullptr);
}

TEST(SceneMessage, HasEveryToolWhereThereAreSeveralOrTheyTurn) {
  const auto texts_of = [](const std::string& tools) {
    const SceneFile scene_file = sceneFileFromText(tools, "x.toml");
    const SceneLookedAt shown{
        .scene_file = scene_file, .soil = scene_file.bed.soil, .grains = {}, .low_m = {}, .high_m = {}};
    return sceneMessages(shown, {Vec3(-1, -1, -1), Vec3(1, 1, 1)});
  };
  EXPECT_FALSE(Json::parse(texts_of("").whole).contains("tools"));
  const Board::Texts texts = texts_of("[[tools]]\nname = 'left'\n[[tools]]\nname = 'right'\nmodel = 'rake'\n");
  const Json scene = Json::parse(texts.whole);
  ASSERT_EQ(scene["tools"].size(), 2U);
  EXPECT_EQ(scene["tools"][0]["name"], "left");
  EXPECT_EQ(scene["tools"][0]["shape"], scene["tool"]["shape"]);
  EXPECT_EQ(scene["tools"][1]["name"], "right");
  EXPECT_EQ(scene["tools"][1]["mesh"]["name"], "rake");
  const Json nameless = Json::parse(texts.nameless);
  ASSERT_EQ(nameless["tools"].size(), 1U) << "a participant sees the own tool";
  EXPECT_EQ(nameless["tools"][0]["name"], "");
  EXPECT_EQ(texts.nameless.find("rake"), std::string::npos);
  const Json wheel = Json::parse(
      texts_of("[tool]\nshape = 'cylinder'\njoint_drive = 'speed'\njoint_axis = [0, 0, 1]\njoint_speed_rad_s = 1\n")
          .whole);
  EXPECT_EQ(wheel["tools"].size(), 1U);
}

TEST(SceneMessage, HasStonesOnlyWhereThereAreAny) {
  const Session session(SceneFile(), false, SettleProgress{});
  EXPECT_FALSE(Json::parse(sceneMessages(session, {Vec3(-1, -1, -1), Vec3(1, 1, 1)}).whole).contains("stones"));
}

TEST(StoneMessage, IsTheMeshOrTheSpheresOfOneWithout) {
  StoneShape stone;
  stone.spheres = {{.centre_m = Vec3(0.001, 0, -0.002), .radius_m = 0.01},
                   {.centre_m = Vec3::Zero(), .radius_m = 0.02}};
  EXPECT_EQ(Json(stoneJson(stone)), Json::parse(R"({"spheres": [[0.001, 0.0, -0.002, 0.01], [0.0, 0.0, 0.0, 0.02]]})"));
  stone.shown = {.points_m = {Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)},
                 .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const Json json = stoneJson(stone);
  EXPECT_EQ(json.size(), 2U);
  const std::string points = fromBase64(json["points_base64"].get<std::string>()).value();
  const std::string triangles = fromBase64(json["triangles_base64"].get<std::string>()).value();
  ASSERT_EQ(points.size(), 12U * 4);
  ASSERT_EQ(triangles.size(), 12U * 4);
  float x_m = 0;
  std::memcpy(&x_m, points.data() + 12, sizeof x_m);
  EXPECT_EQ(x_m, 1);
  std::uint32_t corner = 0;
  std::memcpy(&corner, triangles.data() + 4, sizeof corner);
  EXPECT_EQ(corner, 2U);
}

TEST_F(LiveViewTest, ANewcomerIsToldEverythingInTheOrderOfTheProtocol) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  const Json hello = Json::parse(client.receive().value());
  EXPECT_EQ(hello["type"], "hello");
  EXPECT_EQ(hello["protocol"], 1);
  EXPECT_EQ(hello["client"], 1);
  EXPECT_EQ(hello["presets"].size(), 6U);
  EXPECT_EQ(hello["bodies"].size(), 6U);
  EXPECT_GE(hello["soils"].size(), 5U);
  const Json scene = Json::parse(client.receive().value());
  EXPECT_EQ(scene["type"], "scene");
  EXPECT_EQ(scene["particles"], 256);
  EXPECT_EQ(scene["grains"], Json::parse(R"([{"count": 256, "radius_m": 0.007}])"));
  EXPECT_EQ(scene["soil"]["preset"], "P3");
  EXPECT_NEAR(scene["soil"]["friction_angle_deg"].get<double>(), 39.95, 0.01);
  EXPECT_EQ(scene["sliders"].size(), 2U);
  EXPECT_EQ(scene["body"], "Moon");
  const Json status = client.receive("status").value();
  EXPECT_EQ(status["device"], "virtual hand");
  EXPECT_EQ(status["paused"], false);
  EXPECT_EQ(status["misses_too_long"].get<int>() + status["misses_woken_late"].get<int>() +
                status["misses_preempted"].get<int>(),
            status["misses"]);
  std::string frame = client.receive().value();
  while (client.gotText()) {
    frame = client.receive().value();
  }
  EXPECT_GE(frame.size(), 128U);
}

TEST_F(LiveViewTest, CommandsReachTheSession) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  EXPECT_EQ(ask(client, {{"do", "scene"}, {"body", "Mars"}})["ok"], true);
  EXPECT_TRUE(until(client, "scene", [](const Json& s) { return s["body"] == "Mars" && s["scene"] == 1; }));
  EXPECT_EQ(ask(client, {{"do", "scene"}, {"preset", "P1"}})["ok"], true);
  EXPECT_TRUE(until(client, "scene", [](const Json& s) { return s["scene"] == 2 && s["soil"]["preset"] == "P1"; }));
  EXPECT_EQ(ask(client, {{"do", "undo"}})["ok"], true);
  EXPECT_TRUE(until(client, "scene", [](const Json& s) { return s["scene"] == 3 && s["soil"]["preset"] == "P3"; }));
  EXPECT_EQ(ask(client, {{"do", "pause"}})["ok"], true);
  EXPECT_TRUE(until(client, "status", [](const Json& s) { return s["paused"] == true; }));
  EXPECT_EQ(ask(client, {{"do", "record"}, {"on", true}})["ok"], true);
  EXPECT_TRUE(until(client, "status", [](const Json& s) { return s["recording"] == "tape.csv"; }));
  EXPECT_TRUE(recording_);
}

/// Two shovels side by side.
class TwoToolsTest : public LiveViewTest {
 protected:
  TwoToolsTest()
      : LiveViewTest(false, LiveView::Clients::kCommand, nullptr,
                     sceneFileFromText(
                         "[hand]\nmotion = 'still'\n[[tools]]\nname = 'left'\n[tools.hand]\nhome_mm = [-40, 0, 85]\n"
                         "[[tools]]\nname = 'right'\n[tools.hand]\nhome_mm = [40, 0, 85]\n",
                         "x.toml")) {}

  static Json hold(WsClient& client, const char* tool) {
    return ask(client, {{"do", "hold"}, {"pose", {0.04, 0, 0.09, 1, 0, 0, 0}}, {"tool", tool}});
  }
};

TEST_F(TwoToolsTest, TwoClientsHoldOneEach) {
  WsClient one(port_);
  ASSERT_EQ(one.upgrade(), 101U);
  EXPECT_EQ(one.receive("scene").value()["tools"][1]["name"], "right");
  EXPECT_EQ(hold(one, "right")["ok"], true);
  {
    WsClient other(port_);
    ASSERT_EQ(other.upgrade(), 101U);
    EXPECT_EQ(hold(other, "right")["error"], "another client controls the tool");
    EXPECT_EQ(ask(other, {{"do", "play"}, {"motion", "press"}, {"tool", "right"}})["ok"], false);
    EXPECT_EQ(ask(other, {{"do", "release"}, {"tool", "right"}})["ok"], true) << "which releases nothing";
    EXPECT_EQ(hold(other, "left")["ok"], true);
    EXPECT_TRUE(until(one, "status", [](const Json& s) { return s["held_by"] == 2; }));
    EXPECT_EQ(hold(one, "left")["ok"], false);
  }
  EXPECT_TRUE(until(one, "status", [](const Json& s) { return s["held_by"].is_null(); })) << "it has left";
  EXPECT_EQ(hold(one, "left")["ok"], true);
  EXPECT_EQ(ask(one, {{"do", "release"}})["ok"], true) << "of the first";
  EXPECT_TRUE(until(one, "status", [](const Json& s) { return s["held_by"].is_null(); }));
}

TEST_F(TwoToolsTest, AToolWithoutThatNameIsRefused) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  const std::string error = hold(client, "middle")["error"];
  EXPECT_THAT(error, testing::HasSubstr("tool = 'middle' is not valid: must be the name of a tool in this scene"));
}

TEST_F(TwoToolsTest, AMotionIsOfOneTool) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  EXPECT_EQ(ask(client, {{"do", "play"}, {"motion", "press"}, {"tool", "right"}})["ok"], true);
  EXPECT_TRUE(until(client, "scene", [](const Json& s) {
    return s["tools"][0]["motion"] == "still" && s["tools"][1]["motion"] == "press" && s["hand"]["motion"] == "still";
  }));
}

TEST_F(LiveViewTest, ARobotThatFollowsIsToldOfWithTheStatus) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  EXPECT_TRUE(until(client, "status", [](const Json& s) { return s["robot"].is_null(); }));
  robot_.state = "holding";
  robot_.reason = "too much force";
  robot_.heard = true;
  robot_.behind = 2650;
  robot_.scene_T_tool.position_m = {0.25, 0, 0.5};
  robot_.met_n = {1, 2, -3};
  has_robot_ = true;
  EXPECT_TRUE(until(client, "status", [](const Json& s) { return !s["robot"].is_null(); }));
  EXPECT_TRUE(until(client, "status", [](const Json& s) {
    const Json& robot = s["robot"];
    return robot["state"] == "holding" && robot["reason"] == "too much force" && robot["behind"] == 2650 &&
           robot["pose"] == Json{0.25, 0, 0.5, 1, 0, 0, 0} && robot["met_n"] == Json{1, 2, -3};
  }));
}

TEST_F(LiveViewTest, AFinishedRecordingIsNamedWithItsFolderAndCanBeDownloaded) {
  std::ofstream("tape.csv") << "recorded";
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  EXPECT_TRUE(until(client, "status", [](const Json& s) { return s["recorded"].is_null(); }));
  ask(client, {{"do", "record"}, {"on", true}});
  EXPECT_EQ(WsClient::get(port_, "/recordings/tape.csv").first, 404U) << "still being written";
  ask(client, {{"do", "record"}, {"on", false}});
  EXPECT_TRUE(until(client, "status", [](const Json& s) {
    return s["recording"].is_null() && s["recorded"]["file"] == "tape.csv" &&
           s["recorded"]["folder"] == std::filesystem::current_path().string();
  }));
  EXPECT_EQ(WsClient::get(port_, "/recordings/tape.csv"), std::pair(200U, std::string("recorded")));
  std::filesystem::remove("tape.csv");
}

TEST_F(LiveViewTest, WhatIsRefusedIsSaidAndChangesNothing) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  const Json reply = ask(client, {{"do", "scene"}, {"body", "Venus"}});
  EXPECT_EQ(reply["ok"], false);
  EXPECT_THAT(reply["error"].get<std::string>(), testing::HasSubstr("Ceres"));
  const Json mesh = ask(client, {{"do", "scene"}, {"tool", {{"shape", "mesh"}}}});
  EXPECT_EQ(mesh["ok"], false) << "the scene has none";
  EXPECT_EQ(ask(client, {{"do", "undo"}})["ok"], false);
  EXPECT_EQ(ask(client, {{"do", "hold"}, {"pose", {0, 0, 9, 1, 0, 0, 0}}})["ok"], false);
}

/// A box as text, in the file's own unit.
std::string boxObj(double x, double y, double z) {
  std::string text;
  for (int corner = 0; corner < 8; ++corner) {
    text +=
        fmt::format("v {} {} {}\n", (corner & 1) != 0 ? x : 0, (corner & 2) != 0 ? y : 0, (corner & 4) != 0 ? z : 0);
  }
  return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

TEST_F(LiveViewTest, AnUploadedMeshBecomesTheTool) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  EXPECT_EQ(client.receive("hello").value()["takes_uploads"], true);
  const auto upload = [&](const std::string& text) {
    return Json::parse(WsClient::put(port_, "/upload", text).second)["upload"];
  };
  const Json fits{{"do", "tool_file"}, {"upload", upload(boxObj(5, 4, 0.5))}, {"name", "box.obj"}, {"unit_mm", 10}};
  EXPECT_EQ(ask(client, fits)["ok"], true);
  EXPECT_TRUE(until(client, "scene", [](const Json& s) {
    return s["tool"]["shape"] == "mesh" && s["tool"]["mesh"]["name"] == "box.obj" && s["scene"] == 1;
  })) << "the bed stays";
  EXPECT_THAT(ask(client, fits)["error"].get<std::string>(), testing::HasSubstr("upload it again"));

  Json wrong{{"do", "tool_file"}, {"upload", upload(boxObj(5, 4, 0.5))}, {"name", "box.obj"}, {"unit_mm", 100}};
  EXPECT_EQ(ask(client, wrong)["ok"], true);
  EXPECT_TRUE(until(client, "status", [](const Json& s) {
    return s["problem"].is_string() &&
           s["problem"].get<std::string>().find("box.obj = 50 x 400 x 500 mm") != std::string::npos;
  })) << "wider than the box";
  wrong["upload"] = upload("v 1 2\n");
  EXPECT_EQ(ask(client, wrong)["ok"], true);
  EXPECT_TRUE(until(client, "status", [](const Json& s) {
    return s["problem"].is_string() && s["problem"].get<std::string>().find("a finite number") != std::string::npos;
  }));
  EXPECT_EQ(ask(client, {{"do", "reset"}})["ok"], true);
  EXPECT_TRUE(until(client, "scene", [](const Json& s) {
    return s["tool"]["shape"] == "box" && s["tool"]["mesh"].is_null() && s["scene"] == 2;
  }));
}

/// For as long as it lives, no thread can be started: each would get a larger stack than there are addresses.
class NoMoreThreads {
 public:
  NoMoreThreads() {
    pthread_getattr_default_np(&before_);
    pthread_attr_t huge;
    pthread_getattr_default_np(&huge);
    pthread_attr_setstacksize(&huge, std::size_t{1} << 60);
    pthread_setattr_default_np(&huge);
    pthread_attr_destroy(&huge);
  }
  ~NoMoreThreads() {
    pthread_setattr_default_np(&before_);
    pthread_attr_destroy(&before_);
  }
  NoMoreThreads(const NoMoreThreads&) = delete;
  NoMoreThreads& operator=(const NoMoreThreads&) = delete;

 private:
  pthread_attr_t before_{};
};

TEST_F(LiveViewTest, WithoutThreadsACommandIsRefusedAndTheRunGoesOn) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  {
    const NoMoreThreads none;
    ASSERT_ANY_THROW(startThread());
    for (const Json& command : {Json{{"do", "level"}}, Json{{"do", "reset"}}, Json{{"do", "scene"}, {"preset", "P1"}},
                                Json{{"do", "record"}, {"on", true}}}) {
      const Json reply = ask(client, command);
      EXPECT_EQ(reply["ok"], false) << command;
      EXPECT_THAT(reply["error"].get<std::string>(),
                  testing::AnyOf(testing::HasSubstr("cannot prepare"), testing::HasSubstr("not possible now")))
          << command;
    }
  }
  EXPECT_EQ(ask(client, {{"do", "scene"}, {"body", "Mars"}})["ok"], true);
  EXPECT_TRUE(until(client, "scene", [](const Json& s) { return s["body"] == "Mars" && s["soil"]["preset"] == "P3"; }));
  EXPECT_EQ(ask(client, {{"do", "level"}})["ok"], true);
  EXPECT_TRUE(until(client, "scene", [](const Json& s) { return s["scene"] == 2; }));
}

class OnlookersOfLiveViewTest : public LiveViewTest {
 protected:
  OnlookersOfLiveViewTest() : LiveViewTest(false, LiveView::Clients::kLookOn) {}
};

TEST_F(OnlookersOfLiveViewTest, SeeEverythingAndChangeNothing) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  EXPECT_EQ(Json::parse(client.receive().value())["read_only"], true);
  for (const Json& command :
       {Json{{"do", "scene"}, {"body", "Mars"}}, Json{{"do", "hold"}, {"pose", {0, 0, 0.1, 1, 0, 0, 0}}},
        Json{{"do", "play"}, {"motion", "stir"}}, Json{{"do", "pause"}}, Json{{"do", "resume"}}, Json{{"do", "step"}},
        Json{{"do", "speed"}, {"factor", 0.5}}, Json{{"do", "reset"}}, Json{{"do", "level"}}, Json{{"do", "undo"}},
        Json{{"do", "record"}, {"on", true}}}) {
    const Json reply = ask(client, command);
    EXPECT_EQ(reply["ok"], false) << command;
    EXPECT_THAT(reply["error"].get<std::string>(), testing::HasSubstr("--read-only"));
  }
  EXPECT_EQ(ask(client, {{"do", "colour"}, {"by", "force"}})["ok"], true);
  EXPECT_TRUE(until(client, "status", [](const Json& s) { return s["paused"] == false; }));
}

/// A handle that a person holds, or has put down.
class Handle final : public HapticDevice {
 public:
  explicit Handle(const std::atomic<bool>& held) : held_(held) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "a handle"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    DeviceLimits limits;
    limits.max_force_n = 10;
    limits.max_force_rate_n_s = 100;
    return limits;
  }
  [[nodiscard]] DeviceInput read() noexcept override {
    DeviceInput input;
    input.state = held_ ? DeviceState::kLive : DeviceState::kStale;
    return input;
  }
  void write(const DeviceOutput&) noexcept override {}
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}

 private:
  const std::atomic<bool>& held_;
};

class PersonInLiveViewTest : public LiveViewTest {
 protected:
  PersonInLiveViewTest() : LiveViewTest(false, LiveView::Clients::kCommand, heldHandle()) {}
  /// Held from the first tick on: one that is not held yet is released first, after a picture with its force.
  static std::unique_ptr<HapticDevice> heldHandle() {
    held() = true;
    return std::make_unique<Handle>(held());
  }
  static std::atomic<bool>& held() {
    static std::atomic<bool> held;
    return held;
  }
};

TEST_F(PersonInLiveViewTest, WhatAPersonFeelsIsChangedOnlyWhenThatIsConfirmed) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  ASSERT_TRUE(until(client, "status", [](const Json& s) { return s["person_feels"] == true; }));
  const std::vector<Json> changes{{{"do", "scene"}, {"body", "Mars"}},
                                  {{"do", "scene"}, {"tool", {{"shape", "sphere"}}}},
                                  {{"do", "scene"}, {"sliders", {{"friction_angle_deg", 30}}}},
                                  {{"do", "level"}},
                                  {{"do", "reset"}}};
  for (Json change : changes) {
    EXPECT_THAT(ask(client, change)["error"].get<std::string>(),
                testing::HasSubstr("a user holds the haptic device (a handle)"));
    change["confirmed"] = false;
    EXPECT_EQ(ask(client, change)["ok"], false) << change;
  }
  EXPECT_EQ(ask(client, {{"do", "undo"}})["ok"], false);
  EXPECT_EQ(ask(client, {{"do", "pause"}})["ok"], true) << "which lets go of the hand";
  EXPECT_EQ(ask(client, {{"do", "resume"}})["ok"], true);
  for (Json change : changes) {
    change["confirmed"] = true;
    EXPECT_EQ(ask(client, change)["ok"], true) << change;
  }
  held() = false;
  ASSERT_TRUE(until(client, "status", [](const Json& s) { return s["person_feels"] == false; }));
  EXPECT_EQ(ask(client, changes.front())["ok"], true) << "nobody is there";
}

TEST_F(LiveViewTest, TheFirstToHoldHasTheToolUntilItLetsGoOrLeaves) {
  auto first = std::make_unique<WsClient>(port_);
  WsClient second(port_);
  ASSERT_EQ(first->upgrade(), 101U);
  ASSERT_EQ(second.upgrade(), 101U);
  const Json hold{{"do", "hold"}, {"pose", {0, 0, 0.1, 1, 0, 0, 0}}};
  EXPECT_EQ(ask(*first, hold)["ok"], true);
  EXPECT_EQ(ask(second, hold)["ok"], false);
  EXPECT_EQ(ask(second, {{"do", "play"}, {"motion", "stir"}})["ok"], false);
  EXPECT_EQ(ask(second, {{"do", "release"}})["ok"], true) << "what one does not hold one may let go of";
  EXPECT_TRUE(until(second, "status", [](const Json& s) { return s["held_by"] == 1; }));
  EXPECT_EQ(ask(*first, {{"do", "release"}})["ok"], true);
  EXPECT_EQ(ask(second, hold)["ok"], true);
  EXPECT_EQ(ask(second, {{"do", "release"}})["ok"], true);
  EXPECT_EQ(ask(*first, hold)["ok"], true);
  first.reset();
  EXPECT_TRUE(until(second, "status", [](const Json& s) { return s["held_by"].is_null() && s["clients"] == 1; }));
}

TEST_F(LiveViewTest, APauseLetsGoOfTheToolForEverybody) {
  WsClient first(port_);
  WsClient second(port_);
  ASSERT_EQ(first.upgrade(), 101U);
  ASSERT_EQ(second.upgrade(), 101U);
  const Json hold{{"do", "hold"}, {"pose", {0, 0, 0.1, 1, 0, 0, 0}}};
  EXPECT_EQ(ask(first, {{"do", "step"}})["ok"], false) << "time goes on";
  EXPECT_EQ(ask(first, hold)["ok"], true);
  EXPECT_EQ(ask(first, {{"do", "pause"}})["ok"], true);
  EXPECT_EQ(ask(first, {{"do", "step"}})["ok"], true);
  EXPECT_EQ(ask(first, {{"do", "resume"}})["ok"], true);
  EXPECT_EQ(ask(second, hold)["ok"], true);
}

TEST_F(LiveViewTest, ForcesAreWorkedOutForWhoAsks) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  EXPECT_EQ(ask(client, {{"do", "colour"}, {"by", "force"}})["ok"], true);
  const auto flagsOf = [](const std::string& frame) { return static_cast<unsigned char>(frame[2]); };
  std::optional<std::string> message;
  do {
    message = client.receive();
  } while (message && (client.gotText() || (flagsOf(*message) & 8) == 0));
  ASSERT_TRUE(message);
}

TEST_F(LiveViewTest, WithoutAGuestNoStudyIsRunning) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  const Json reply = ask(client, {{"do", "study"}, {"act", "join"}, {"as", "participant"}});
  EXPECT_EQ(reply["ok"], false);
  EXPECT_EQ(reply["error"], "no study is running");
}

class GuestOfLiveViewTest : public LiveViewTest {
 protected:
  GuestOfLiveViewTest() : LiveViewTest(true) {}
};

TEST_F(GuestOfLiveViewTest, TheGuestTalksWithClients) {
  WsClient other(port_);
  WsClient client(port_);
  ASSERT_EQ(other.upgrade(), 101U);
  ASSERT_EQ(client.upgrade(), 101U);
  client.send(R"({"do": "study", "act": "join"})");
  const std::optional<Json> welcome = client.receive("study");
  ASSERT_TRUE(welcome);
  EXPECT_EQ((*welcome)["welcome"], 2);
  EXPECT_EQ(ask(client, {{"do", "study"}, {"act", "read"}, {"text", std::string(10'000, 'x')}})["ok"], true);
}

TEST_F(GuestOfLiveViewTest, WhatTheGuestRefusesOrThrowsIsSaid) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  EXPECT_EQ(ask(client, {{"do", "study"}, {"act", "nonsense"}})["error"], "there is no such act");
  const Json thrown = ask(client, {{"do", "study"}, {"act", "throw"}});
  EXPECT_EQ(thrown["ok"], false);
  EXPECT_THAT(thrown["error"].get<std::string>(), testing::HasSubstr("kind"));
  const Json refused_by_system = ask(client, {{"do", "study"}, {"act", "ask too much"}});
  EXPECT_THAT(refused_by_system["error"].get<std::string>(), testing::HasSubstr("no thread"));
  EXPECT_EQ(ask(client, {{"do", "study"}, {"act", "go"}})["ok"], true) << "and all goes on";
}

TEST_F(GuestOfLiveViewTest, TheGuestKeepsClientsFromCommanding) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  const Json refused = ask(client, {{"do", "scene"}, {"preset", "P1"}});
  EXPECT_EQ(refused["error"], "a study is running");
  EXPECT_EQ(ask(client, {{"do", "pause"}})["ok"], false);
  EXPECT_THAT(ask(client, {{"do", "step"}, {"ticks", 0}})["error"].get<std::string>(), testing::HasSubstr("1 to 1000"))
      << "nonsense is refused before the guest is asked";
  EXPECT_TRUE(until(client, "status", [](const Json& s) { return s["paused"] == false; }));
}

TEST_F(GuestOfLiveViewTest, WhoMayHoldNoMoreIsLetGo) {
  WsClient client(port_);
  WsClient other(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  ASSERT_EQ(other.upgrade(), 101U);
  const Json hold{{"do", "hold"}, {"pose", {0, 0, 0.1, 1, 0, 0, 0}}};
  EXPECT_EQ(ask(client, hold)["ok"], true);
  EXPECT_EQ(ask(other, {{"do", "study"}, {"act", "let go"}})["ok"], true);
  EXPECT_TRUE(until(client, "status", [](const Json& s) { return s["held_by"].is_null(); }));
  EXPECT_EQ(ask(client, hold)["ok"], true);
  EXPECT_TRUE(until(client, "status", [](const Json& s) { return s["held_by"] == 1; }));
  EXPECT_EQ(ask(other, {{"do", "study"}, {"act", "hold no more"}})["ok"], true);
  EXPECT_EQ(ask(client, hold)["error"], "not now");
  EXPECT_TRUE(until(client, "status", [](const Json& s) { return s["held_by"].is_null(); }));
}

TEST_F(GuestOfLiveViewTest, TheGuestIsToldWhoLeft) {
  WsClient stays(port_);
  auto leaves = std::make_unique<WsClient>(port_);
  ASSERT_EQ(stays.upgrade(), 101U);
  ASSERT_EQ(leaves->upgrade(), 101U);
  leaves.reset();
  EXPECT_TRUE(until(stays, "status", [](const Json& s) { return s["clients"] == 1; }));
  for (int i = 0; i < 1000 && extension_.left == 0; ++i) {
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(extension_.left, 2U);
}

}  // namespace
}  // namespace haptolith

#include "haptolith/viewer/live_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "haptolith/core/error.h"

#include "ws_client.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

/// A guest that greets, and lets the tool be held until it is told otherwise, but nothing else be done.
struct TalkingGuest {
  LiveView* view = nullptr;
  std::atomic<std::uint32_t> left{0};
  std::atomic<bool> may_hold{true};

  std::string obey(std::uint32_t client, const Json& message) {
    if (message["act"] == "throw") {
      throw InvalidParameter("act", "throw", "kind");
    }
    if (message["act"] == "let go") {
      view->letGo();
    }
    if (message["act"] == "hold no more") {
      may_hold = false;
    }
    if (message["act"] == "join") {
      view->send(client, Json{{"type", "study"}, {"welcome", client}}.dump());
    }
    return message["act"] == "nonsense" ? "there is no such act" : "";
  }

  LiveView::Guest functions() {
    return {.obey = [this](std::uint32_t client, std::string_view text) { return obey(client, Json::parse(text)); },
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
  explicit LiveViewTest(bool has_guest = false) {
    Scenario scenario;
    scenario.hand.manoeuvre = Manoeuvre::kStill;
    scenario.loop.paced = false;
    session_ = std::make_unique<Session>(scenario, false);
    view_ = std::make_unique<LiveView>(*session_, WebServerOptions{.port = 0}, "test",
                                       LiveView::Recorder{.start = [this] { recording_ = true; },
                                                          .stop = [this] { recording_ = false; },
                                                          .name = [this] { return recording_ ? "tape.csv" : ""; }},
                                       has_guest ? guest_.functions() : LiveView::Guest{});
    guest_.view = view_.get();
    const std::string url = view_->url();
    port_ = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
    session_->start(stop_);
    thread_ = std::thread([this] {
      while (!session_->done()) {
        view_->obey();
        const bool changed = session_->poll();
        view_->show(session_->update(), changed);
        std::this_thread::sleep_for(1ms);
      }
    });
  }
  ~LiveViewTest() override {
    stop_ = true;
    thread_.join();
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

  std::atomic<bool> stop_{false}, recording_{false};
  TalkingGuest guest_;
  std::unique_ptr<Session> session_;
  std::unique_ptr<LiveView> view_;
  std::thread thread_;
  std::uint16_t port_ = 0;
};

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
  EXPECT_EQ(scene["soil"]["preset"], "P3");
  EXPECT_NEAR(scene["soil"]["friction_angle_deg"].get<double>(), 39.95, 0.01);
  EXPECT_EQ(scene["sliders"].size(), 2U);
  EXPECT_EQ(scene["body"], "Moon");
  const Json status = client.receive("status").value();
  EXPECT_EQ(status["device"], "virtual hand");
  EXPECT_EQ(status["paused"], false);
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

TEST_F(LiveViewTest, WhatIsRefusedIsSaidAndChangesNothing) {
  WsClient client(port_);
  ASSERT_EQ(client.upgrade(), 101U);
  const Json reply = ask(client, {{"do", "scene"}, {"body", "Venus"}});
  EXPECT_EQ(reply["ok"], false);
  EXPECT_THAT(reply["error"].get<std::string>(), testing::HasSubstr("Ceres"));
  EXPECT_EQ(ask(client, {{"do", "undo"}})["ok"], false);
  EXPECT_EQ(ask(client, {{"do", "hold"}, {"pose", {0, 0, 9, 1, 0, 0, 0}}})["ok"], false);
}

TEST_F(LiveViewTest, TheFirstToHoldHasTheToolUntilItLetsGoOrLeaves) {
  auto first = std::make_unique<WsClient>(port_);
  WsClient second(port_);
  ASSERT_EQ(first->upgrade(), 101U);
  ASSERT_EQ(second.upgrade(), 101U);
  const Json hold{{"do", "hold"}, {"pose", {0, 0, 0.1, 1, 0, 0, 0}}};
  EXPECT_EQ(ask(*first, hold)["ok"], true);
  EXPECT_EQ(ask(second, hold)["ok"], false);
  EXPECT_EQ(ask(second, {{"do", "play"}, {"manoeuvre", "stir"}})["ok"], false);
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
  for (int i = 0; i < 1000 && guest_.left == 0; ++i) {
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(guest_.left, 2U);
}

}  // namespace
}  // namespace haptolith

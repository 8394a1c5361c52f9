#include "haptolith/viewer/web_server.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <thread>
#include <tuple>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/viewer/access.h"

#include "ws_client.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
namespace http = boost::beast::http;

class WebServerTest : public testing::Test {
 protected:
  explicit WebServerTest(const WebServerOptions& options = {.port = 0}) : server_(options, board_) {}

  void takeAll() {
    for (WebServer::Event event; server_.takeEvent(event);) {
      events_.push_back(std::move(event));
    }
  }

  bool soon(const std::function<bool()>& is_so) {
    for (int i = 0; i < 5000; ++i) {
      takeAll();
      if (is_so()) {
        return true;
      }
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }

  Board board_{R"({"type":"hello","client":"$client"})"};
  WebServer server_;
  std::vector<WebServer::Event> events_;
};

TEST_F(WebServerTest, ServesThePageAndNothingElse) {
  const auto [status, body] = WsClient::get(server_.port(), "/");
  EXPECT_EQ(status, 200U);
  EXPECT_THAT(body, HasSubstr("haptolith"));
  EXPECT_EQ(WsClient::get(server_.port(), "/index.html?view=top").first, 200U);
  for (const char* nothing : {"/no", "/../etc/passwd", "/%2e%2e/etc/passwd", "//", "/index.html/", "*"}) {
    EXPECT_EQ(WsClient::get(server_.port(), nothing).first, 404U) << nothing;
  }
  EXPECT_EQ(WsClient::get(server_.port(), "/", {}, http::verb::head).first, 200U);
  EXPECT_EQ(WsClient::get(server_.port(), "/", {}, http::verb::delete_).first, 405U);
}

/// A folder with a recording, and another file next to it.
class RecordingsTest : public testing::Test {
 protected:
  RecordingsTest() {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "tape.h5") << std::string(300'000, 'r');
    std::ofstream(folder_ / "secret.h5") << "secret";
  }
  ~RecordingsTest() override { std::filesystem::remove_all(folder_); }

  /// Offers the tape, and waits until the server's thread has it.
  static bool offers(WebServer& server, const std::filesystem::path& file, const std::string& query) {
    server.offer(file);
    for (int i = 0; i < 5000; ++i) {
      if (WsClient::get(server.port(), "/recordings/tape.h5" + query).first == 200) {
        return true;
      }
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }

  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("haptolith-recordings-" + std::to_string(getpid()));
  Board board_{R"({"type":"hello","client":"$client"})"};
};

TEST_F(RecordingsTest, OnlyWhatHasBeenOfferedIsServedWhole) {
  WebServer server({.port = 0}, board_);
  EXPECT_EQ(WsClient::get(server.port(), "/recordings/tape.h5").first, 404U) << "not offered";
  ASSERT_TRUE(offers(server, folder_ / "tape.h5", ""));
  EXPECT_EQ(WsClient::get(server.port(), "/recordings/tape.h5").second, std::string(300'000, 'r'));
  EXPECT_EQ(WsClient::get(server.port(), "/recordings/tape.h5", {}, http::verb::head).first, 200U);
  for (const char* other :
       {"/recordings/secret.h5", "/recordings/", "/recordings/../tape.h5", "/recordings/./tape.h5",
        "/recordings/%2e%2e/secret.h5", "/recordings/../../../../etc/passwd", "/recordings//etc/passwd", "/tape.h5"}) {
    EXPECT_EQ(WsClient::get(server.port(), other).first, 404U) << other;
  }
  EXPECT_EQ(WsClient::get(server.port(), "/recordings/tape.h5", "evil.com").first, 403U);
  EXPECT_EQ(WsClient::get(server.port(), "/recordings/tape.h5", {}, http::verb::put).first, 405U);
  std::filesystem::remove(folder_ / "tape.h5");
  EXPECT_EQ(WsClient::get(server.port(), "/recordings/tape.h5").first, 404U) << "removed since";
}

TEST_F(RecordingsTest, AreForWhoHasATokenThatTellsWhatIsShown) {
  WebServer server({.port = 0, .entrances = {{.token = "one", .nameless = true}, {.token = "another"}}}, board_);
  ASSERT_TRUE(offers(server, folder_ / "tape.h5", "?token=another"));
  EXPECT_EQ(WsClient::get(server.port(), "/recordings/tape.h5").first, 401U);
  EXPECT_EQ(WsClient::get(server.port(), "/recordings/tape.h5?token=wrong").first, 401U);
  EXPECT_EQ(WsClient::get(server.port(), "/recordings/no.h5").first, 401U) << "nor what there is";
  EXPECT_EQ(WsClient::get(server.port(), "/recordings/tape.h5?token=one").first, 403U);
}

class UploadTest : public WebServerTest {
 protected:
  UploadTest() : WebServerTest({.port = 0, .takes_uploads = true}) {}

  [[nodiscard]] std::string url() const { return "http://127.0.0.1:" + std::to_string(server_.port()); }
};

TEST_F(UploadTest, TheNewestIsKeptUntilItIsTaken) {
  const std::string large(kLargestUpload, 'x');
  EXPECT_EQ(WsClient::put(server_.port(), "/upload", "first"), std::pair(200U, std::string("{\"upload\": 1}\n")));
  EXPECT_EQ(WsClient::put(server_.port(), "/upload", large, url()), std::pair(200U, std::string("{\"upload\": 2}\n")));
  EXPECT_EQ(server_.takeUpload(1), nullptr);
  const std::shared_ptr<const std::string> taken = server_.takeUpload(2);
  ASSERT_NE(taken, nullptr);
  EXPECT_TRUE(*taken == large);
  EXPECT_EQ(server_.takeUpload(2), nullptr) << "once";
  EXPECT_EQ(server_.takeUpload(3), nullptr);
}

TEST_F(UploadTest, WhatIsTooLargeOrFromElsewhereIsRefused) {
  EXPECT_EQ(WsClient::put(server_.port(), "/upload", std::string(kLargestUpload + 1, 'x')).first, 413U);
  EXPECT_EQ(WsClient::put(server_.port(), "/upload", "x", "http://evil.com").first, 403U);
  EXPECT_EQ(WsClient::put(server_.port(), "/uploads", "x").first, 400U) << "only uploads have a body";
  EXPECT_EQ(WsClient::put(server_.port(), "/index.html", "x").first, 400U);
  EXPECT_EQ(WsClient::get(server_.port(), "/upload").first, 404U);
  EXPECT_EQ(WsClient::put(server_.port(), "/upload", "").second, "{\"upload\": 1}\n") << "an empty one is one";
}

TEST_F(UploadTest, OneAtATimeAndOneThatBreaksOffHoldsNobodyUp) {
  namespace asio = boost::asio;
  asio::io_context io;
  asio::ip::tcp::socket slow(io);
  slow.connect({asio::ip::make_address("127.0.0.1"), server_.port()});
  asio::write(slow,
              asio::buffer(std::string("PUT /upload HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\nhalf")));
  EXPECT_TRUE(soon([&] { return WsClient::put(server_.port(), "/upload", "x").first == 503U; }));
  slow.close();
  EXPECT_TRUE(soon([&] { return WsClient::put(server_.port(), "/upload", "x").first == 200U; }));
}

TEST(Upload, IsForWhoHasATokenThatTellsWhatIsShown) {
  Board board{R"({"type":"hello","client":"$client"})"};
  WebServer server(
      {.port = 0, .entrances = {{.token = "one", .nameless = true}, {.token = "another"}}, .takes_uploads = true},
      board);
  EXPECT_EQ(WsClient::put(server.port(), "/upload", "x").first, 401U);
  EXPECT_EQ(WsClient::put(server.port(), "/upload?token=wrong", "x").first, 401U);
  EXPECT_EQ(WsClient::put(server.port(), "/upload?token=one", "x").first, 403U);
  EXPECT_EQ(WsClient::put(server.port(), "/upload?token=another", "x").first, 200U);
}

TEST_F(WebServerTest, TakesNoUploadsUnlessItIsTold) {
  EXPECT_EQ(WsClient::put(server_.port(), "/upload", "x").first, 400U);
  EXPECT_EQ(server_.takeUpload(0), nullptr);
}

TEST_F(WebServerTest, OnlyPagesOfThisMachineMayConnect) {
  const auto [status_of_another, advice] = WsClient::get(server_.port(), "/", "evil.com");
  EXPECT_EQ(status_of_another, 403U) << "a name that was pointed at us";
  EXPECT_THAT(advice, testing::HasSubstr("--bind")) << "for a proxy";
  EXPECT_EQ(WsClient::get(server_.port(), "/", "localhost:1234").first, 200U) << "forwarded through SSH";
  const auto status = [&](const std::string& origin, const std::string& host) {
    WsClient client(server_.port());
    client.origin_ = origin;
    if (!host.empty()) {
      client.host_ = host;
    }
    return client.upgrade();
  };
  const std::string port = std::to_string(server_.port());
  EXPECT_EQ(status("", ""), 101U) << "a program";
  EXPECT_EQ(status("http://127.0.0.1:" + port, ""), 101U);
  EXPECT_EQ(status("http://localhost:9000", "localhost:9000"), 101U);
  EXPECT_EQ(status("http://evil.com", ""), 403U);
  EXPECT_EQ(status("http://localhost:" + port, ""), 403U);
  EXPECT_EQ(status("null", ""), 403U);
  EXPECT_EQ(status("http://evil.com", "evil.com"), 403U);
}

TEST_F(WebServerTest, AnotherProtocolOrPathIsRefused) {
  WsClient old(server_.port());
  old.protocol_ = "haptolith.0";
  EXPECT_EQ(old.upgrade(), 400U);
  WsClient none(server_.port());
  none.protocol_.clear();
  EXPECT_EQ(none.upgrade(), 400U);
  WsClient elsewhere(server_.port());
  elsewhere.target_ = "/socket";
  EXPECT_EQ(elsewhere.upgrade(), 404U);
}

TEST_F(WebServerTest, MessagesGoBothWaysAndLeavingIsNoticed) {
  auto client = std::make_unique<WsClient>(server_.port());
  ASSERT_EQ(client->upgrade(), 101U);
  EXPECT_EQ(client->receive(), R"({"type":"hello","client":1})");
  ASSERT_TRUE(soon([&] { return events_.size() == 1; }));
  EXPECT_EQ(events_[0].kind, WebServer::Event::Kind::kJoined);
  EXPECT_EQ(server_.clients(), 1U);

  client->send("to you");
  ASSERT_TRUE(soon([&] { return events_.size() == 2; }));
  EXPECT_EQ(events_[1].text, "to you");
  EXPECT_EQ(events_[1].client, 1U);
  server_.send(1, "to me");
  EXPECT_EQ(client->receive(), "to me");
  server_.send(77, "to nobody");

  board_.setStatus("status");
  server_.notify();
  EXPECT_EQ(client->receive(), "status");

  client.reset();
  ASSERT_TRUE(soon([&] { return events_.size() == 3; }));
  EXPECT_EQ(events_[2].kind, WebServer::Event::Kind::kLeft);
  EXPECT_TRUE(soon([&] { return server_.clients() == 0; }));
}

TEST_F(WebServerTest, AMessageThatIsTooLongOrNoTextEndsTheConnection) {
  WsClient longwinded(server_.port());
  ASSERT_EQ(longwinded.upgrade(), 101U);
  (void)longwinded.receive();
  longwinded.send(std::string(16384, 'x'));
  ASSERT_TRUE(soon([&] { return !events_.empty() && events_.back().text.size() == 16384; })) << "as long as may be";
  longwinded.send(std::string(16385, 'x'));
  EXPECT_EQ(longwinded.receive(), std::nullopt);
  EXPECT_EQ(longwinded.closeCode(), 1009);

  WsClient binary(server_.port());
  ASSERT_EQ(binary.upgrade(), 101U);
  (void)binary.receive();
  binary.send("bytes", true);
  EXPECT_EQ(binary.receive(), std::nullopt);
  EXPECT_EQ(binary.closeCode(), 1003);
}

TEST_F(WebServerTest, WhoTalksTooMuchIsDropped) {
  WsClient client(server_.port());
  ASSERT_EQ(client.upgrade(), 101U);
  (void)client.receive();
  // On a busy machine a second may pass before 250 have been read: then once more.
  bool left = false;
  for (int round = 0; round < 20 && !left; ++round) {
    for (int i = 0; i < 300; ++i) {
      client.send("again");
    }
    std::this_thread::sleep_for(100ms);
    takeAll();
    left = events_.back().kind == WebServer::Event::Kind::kLeft;
  }
  EXPECT_TRUE(left);
  EXPECT_EQ(client.receive(), std::nullopt);
}

TEST_F(WebServerTest, WhoSendsMoreThanMayWaitIsDroppedAndWithItWhatWaits) {
  WsClient client(server_.port());
  ASSERT_EQ(client.upgrade(), 101U);
  (void)client.receive();
  for (int i = 0; i < 9; ++i) {  // eight may wait, and none is taken
    client.send(std::string(16384, 'x'));
  }
  EXPECT_EQ(client.receive(), std::nullopt);
  EXPECT_EQ(client.closeCode(), 1008);
  ASSERT_TRUE(soon([&] { return !events_.empty() && events_.back().kind == WebServer::Event::Kind::kLeft; }));
  EXPECT_EQ(events_.size(), 2U) << "it came and went";
}

TEST_F(WebServerTest, ClientsHaveTheirTurnsWhoeverSendsMore) {
  {
    WsClient talks(server_.port());
    ASSERT_EQ(talks.upgrade(), 101U);
    (void)talks.receive();  // else the connection would be reset when it ends, and what is on its way be lost
    for (int i = 0; i < 100; ++i) {
      talks.send(std::to_string(i));
    }
    WsClient says_one_word(server_.port());
    ASSERT_EQ(says_one_word.upgrade(), 101U);
    (void)says_one_word.receive();
    says_one_word.send("word");
  }
  for (int i = 0; i < 5000 && server_.clients() > 0; ++i) {
    std::this_thread::sleep_for(1ms);
  }
  takeAll();
  ASSERT_EQ(events_.size(), 105U);
  EXPECT_EQ(events_[0].client, 1U);
  EXPECT_EQ(events_[3].text, "word") << "both have come, one has said something";
  int next = 0;
  for (const WebServer::Event& event : events_) {
    if (event.client == 1 && event.kind == WebServer::Event::Kind::kMessage) {
      EXPECT_EQ(event.text, std::to_string(next++)) << "each client's in their order";
    }
  }
  EXPECT_EQ(next, 100);
}

TEST_F(WebServerTest, ThirtyTwoClientsAreFineAndOneMoreIsNot) {
  std::vector<std::unique_ptr<WsClient>> clients;
  for (int i = 0; i < 32; ++i) {
    clients.push_back(std::make_unique<WsClient>(server_.port()));
    ASSERT_EQ(clients.back()->upgrade(), 101U) << i;
  }
  WsClient late(server_.port());
  EXPECT_EQ(late.upgrade(), 503U);
  board_.setStatus("status");
  server_.notify();
  for (const auto& client : clients) {
    EXPECT_THAT(client->receive().value_or(""), HasSubstr("hello"));
    EXPECT_EQ(client->receive(), "status");
  }
  clients.pop_back();
  ASSERT_TRUE(soon([&] { return server_.clients() == 31; }));
  WsClient next(server_.port());
  EXPECT_EQ(next.upgrade(), 101U);
}

TEST_F(WebServerTest, AClientThatDoesNotReadGetsNoQueueAndHoldsUpNobody) {
  WsClient stalled(server_.port());
  ASSERT_EQ(stalled.upgrade(), 101U);
  WsClient quick(server_.port());
  ASSERT_EQ(quick.upgrade(), 101U);
  EXPECT_THAT(quick.receive().value_or(""), HasSubstr("hello"));
  const std::string large(4'000'000, 'x');  // fills the socket's buffers
  for (int i = 0; i < 50; ++i) {
    board_.setStatus(std::to_string(i) + large);
    server_.notify();
    EXPECT_THAT(quick.receive().value_or(""), StartsWith(std::to_string(i)));
  }
  // The stalled one is sent what was on its way, and then the newest, not the fifty.
  std::vector<std::string> received;
  for (std::optional<std::string> text; received.size() < 50 && (text = stalled.receive());) {
    received.push_back(text->substr(0, 2));
    if (received.back() == "49") {
      break;
    }
  }
  EXPECT_LE(received.size(), 5U);
  EXPECT_EQ(received.back(), "49");
}

/// Answer of the server to these bytes, until it hangs up.
std::string answerTo(std::uint16_t port, const std::string& request) {
  boost::asio::io_context io;
  boost::asio::ip::tcp::socket socket(io);
  socket.connect({boost::asio::ip::make_address("127.0.0.1"), port});
  boost::beast::error_code ignored;
  boost::asio::write(socket, boost::asio::buffer(request), ignored);
  std::string answer;
  boost::asio::read(socket, boost::asio::dynamic_buffer(answer), ignored);
  return answer;
}

TEST_F(WebServerTest, AnotherSubprotocolThatContainsItsNameIsRefused) {
  for (const auto& [asked, status] : {std::pair("evilhaptolith.1x", 400U),
                                      {"haptolith.10", 400U},
                                      {"haptolith", 400U},
                                      {"HAPTOLITH.1", 400U},
                                      {"chat, haptolith.1", 101U},
                                      {"haptolith.1,chat", 101U}}) {
    WsClient client(server_.port());
    client.protocol_ = asked;
    EXPECT_EQ(client.upgrade(), status) << asked;
  }
}

TEST_F(WebServerTest, WhatIsNoRequestIsAnsweredSo) {
  const auto starts = [&](const std::string& request) { return answerTo(server_.port(), request).substr(0, 12); };
  EXPECT_EQ(starts("rubbish\r\n\r\n"), "HTTP/1.1 400");
  EXPECT_EQ(starts("GET / HTTP/9\r\n\r\n"), "HTTP/1.1 400");
  EXPECT_EQ(starts("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nhello"), "HTTP/1.1 400");
  EXPECT_EQ(starts("GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(10'000, 'x') + "\r\n\r\n"), "HTTP/1.1 431");
}

TEST_F(WebServerTest, HostAndOriginMayBeGivenOnlyOnce) {
  const std::string upgrade =
      "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: "
      "haptolith.1\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
  for (const char* twice : {"Host: localhost\r\nHost: evil.com\r\n", "Host: evil.com\r\nHost: localhost\r\n",
                            "Host: localhost\r\nOrigin: http://localhost\r\nOrigin: http://evil.com\r\n",
                            "Host: localhost\r\nOrigin:\r\nOrigin: http://evil.com\r\n"}) {
    EXPECT_THAT(answerTo(server_.port(), std::string("GET /ws HTTP/1.1\r\n") + twice + upgrade),
                StartsWith("HTTP/1.1 400"))
        << twice;
  }
}

TEST_F(WebServerTest, ThePageMayConnectToItsOwnProgramOnly) {
  const std::string answer = answerTo(server_.port(), "GET / HTTP/1.0\r\nHost: localhost\r\n\r\n");
  EXPECT_THAT(answer, AllOf(StartsWith("HTTP/1.0 200"), HasSubstr("connect-src 'self';"), Not(HasSubstr("ws:"))));
}

TEST_F(WebServerTest, RubbishInsteadOfARequestIsSurvived) {
  for (const std::string& rubbish :
       {std::string("\r\n\r\n"), std::string(10'000, 'A'), std::string("GET / HTTP/9\r\n\r\n"),
        std::string("GET /ws HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n\r\n"), std::string(64, '\0')}) {
    boost::asio::io_context io;
    boost::asio::ip::tcp::socket socket(io);
    socket.connect({boost::asio::ip::make_address("127.0.0.1"), server_.port()});
    boost::beast::error_code ignored;
    boost::asio::write(socket, boost::asio::buffer(rubbish), ignored);
  }
  EXPECT_EQ(WsClient::get(server_.port(), "/").first, 200U);
}

/// A connection that may ask for something later.
class Idler {
 public:
  explicit Idler(std::uint16_t port, const char* from = "127.0.0.1") {
    socket_.open(Tcp::v4());
    socket_.bind({boost::asio::ip::make_address(from), 0});
    socket_.connect({boost::asio::ip::make_address("127.0.0.1"), port});
  }
  void ask(const std::string& target = "/") {
    boost::beast::error_code ignored;
    boost::asio::write(socket_, boost::asio::buffer("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n"), ignored);
  }
  /// The first line that comes; empty when the other side has hung up.
  std::string answer() {
    std::string line;
    boost::beast::error_code ignored;
    boost::asio::read_until(socket_, boost::asio::dynamic_buffer(line), "\r\n", ignored);
    return line.substr(0, line.find("\r\n"));
  }

 private:
  using Tcp = boost::asio::ip::tcp;
  boost::asio::io_context io_;
  Tcp::socket socket_{io_};
};

/// With so few visitors that a test can crowd them out.
class CrowdedWebServerTest : public WebServerTest {
 protected:
  CrowdedWebServerTest() : WebServerTest({.port = 0, .most_asking = 64, .most_served = 64}) {}
};

TEST_F(CrowdedWebServerTest, ConnectionsThatAskForNothingKeepNobodyOut) {
  WsClient inside(server_.port());
  ASSERT_EQ(inside.upgrade(), 101U);
  EXPECT_THAT(inside.receive().value_or(""), HasSubstr("hello"));
  std::deque<Idler> idlers;
  for (int visitor = 0; visitor < 14; ++visitor) {
    for (int i = 0; i < (visitor == 0 ? 300 : 70); ++i) {
      idlers.emplace_back(server_.port());
      if (idlers.size() > 300) {
        idlers.pop_front();
      }
    }
    ASSERT_EQ(WsClient::get(server_.port(), "/").first, 200U) << visitor;
    WsClient newcomer(server_.port());
    ASSERT_EQ(newcomer.upgrade(), 101U) << visitor;
    board_.setStatus(std::to_string(visitor));
    server_.notify();
    EXPECT_EQ(inside.receive(), std::to_string(visitor));
  }
}

TEST_F(CrowdedWebServerTest, ConnectionsThatStayAfterTheirAnswerKeepNobodyOut) {
  std::deque<Idler> idlers;
  for (int i = 0; i < 300; ++i) {
    idlers.emplace_back(server_.port()).ask();  // and does not read
  }
  EXPECT_EQ(WsClient::get(server_.port(), "/").first, 200U);
}

TEST_F(CrowdedWebServerTest, WhoComesFromElsewhereDoesNotPayForThem) {
  Idler patient(server_.port(), "127.0.0.2");
  std::deque<Idler> idlers;
  for (int i = 0; i < 200; ++i) {
    idlers.emplace_back(server_.port());
  }
  EXPECT_EQ(WsClient::get(server_.port(), "/").first, 200U);
  EXPECT_EQ(idlers.front().answer(), "") << "sent away for the others";
  patient.ask();
  EXPECT_EQ(patient.answer(), "HTTP/1.1 200 OK");
}

TEST_F(WebServerTest, WithoutFileDescriptorsTheServerWaitsInsteadOfSpinning) {
  constexpr rlim_t kFewFiles = 256;
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit few{std::min(kFewFiles, before.rlim_max), before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  boost::asio::io_context io;
  boost::asio::ip::tcp::socket late(io);
  late.open(boost::asio::ip::tcp::v4());
  std::vector<int> all_others;
  for (int file = dup(STDIN_FILENO); file >= 0; file = dup(STDIN_FILENO)) {
    all_others.push_back(file);
  }
  late.connect({boost::asio::ip::make_address("127.0.0.1"), server_.port()});
  const std::clock_t began = std::clock();
  std::this_thread::sleep_for(500ms);
  const double spent_s = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
  for (const int file : all_others) {
    close(file);
  }
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_LT(spent_s, 0.1);
  boost::asio::write(late, boost::asio::buffer(std::string("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")));
  std::string line;
  boost::asio::read_until(late, boost::asio::dynamic_buffer(line), "\r\n");
  EXPECT_THAT(line, StartsWith("HTTP/1.1 200")) << "and serves who waited";
}

TEST_F(WebServerTest, ATakenPortIsPassedOver) {
  Board board("hello");
  const WebServer second({.port = server_.port()}, board);
  EXPECT_GT(second.port(), server_.port());
  EXPECT_EQ(second.url(), "http://127.0.0.1:" + std::to_string(second.port()) + "/");
}

TEST(WebServerAddress, APortThatSomebodyWantsIsThatOrNone) {
  Board board("hello");
  const WebServer first({.port = 0}, board);
  EXPECT_THROW(WebServer({.port = first.port(), .other_ports = false}, board), Failure);
}

TEST(WebServerAddress, BeyondThisMachineATokenIsDemanded) {
  Board board("hello");
  EXPECT_THROW(WebServer({.bind = "0.0.0.0", .port = 0}, board), InvalidParameter);
  EXPECT_THROW(WebServer({.bind = "nowhere", .port = 0}, board), InvalidParameter);
  const WebServer server({.bind = "0.0.0.0", .port = 0, .entrances = {{.token = "secret"}}}, board);
  EXPECT_THAT(server.url(), HasSubstr("?token=secret"));
  EXPECT_THAT(server.url(), Not(HasSubstr("0.0.0.0"))) << "which opens nowhere else";
  EXPECT_EQ(server.urlHere(), fmt::format("http://127.0.0.1:{}/?token=secret", server.port()));
  EXPECT_EQ(WsClient::get(server.port(), "/ws").first, 401U);
  EXPECT_EQ(WsClient::get(server.port(), "/ws?token=secre").first, 401U);
  EXPECT_EQ(WsClient::get(server.port(), "/ws?token=secret", "lab.example").first, 426U);
  EXPECT_EQ(WsClient::get(server.port(), "/").first, 200U)
      << "the page, which has nothing to hide, may be loaded again";
  WsClient stranger(server.port());
  EXPECT_EQ(stranger.upgrade(), 401U);
  WsClient guest(server.port());
  guest.target_ = "/ws?token=secret";
  EXPECT_EQ(guest.upgrade(), 101U);
}

TEST(WebServerAddress, GuessesAreTakenSlowlyFromEachAddress) {
  Board board("hello");
  const WebServer server({.port = 0, .entrances = {{.token = "right"}}, .guessable = true}, board);
  unsigned guessed = 0;
  unsigned last = 0;
  for (int i = 0; i < 100; ++i) {
    last = WsClient::get(server.port(), "/ws?token=wrong").first;
    guessed += last == 401U ? 1 : 0;
  }
  EXPECT_EQ(last, 429U);
  EXPECT_GE(guessed, 20U);
  EXPECT_LT(guessed, 60U) << "one a second more";
  EXPECT_EQ(WsClient::get(server.port(), "/").first, 200U);
  Idler elsewhere(server.port(), "127.0.0.2");
  elsewhere.ask("/ws?token=right");
  EXPECT_EQ(elsewhere.answer(), "HTTP/1.1 426 Upgrade Required");

  const WebServer unguessable({.port = 0, .entrances = {{.token = newToken()}}}, board);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(WsClient::get(unguessable.port(), "/ws?token=wrong").first, 401U);
  }
}

TEST(WebServerAddress, EachTokenIsAnEntranceOfItsOwn) {
  Board board("hello");
  WebServer server({.port = 0, .entrances = {{.token = "one", .nameless = true}, {.token = "another"}}}, board);
  board.setScene({"P1", "some soil"});
  EXPECT_THAT(server.url(0), HasSubstr("?token=one"));
  EXPECT_THAT(server.url(1), HasSubstr("?token=another"));
  WsClient stranger(server.port());
  EXPECT_EQ(stranger.upgrade(), 401U) << "on this machine, too";
  std::vector<WebServer::Event> events;
  for (const auto& [token, entrance, scene] : {std::tuple("another", 1U, "P1"), std::tuple("one", 0U, "some soil")}) {
    WsClient client(server.port());
    client.target_ = std::string("/ws?token=") + token;
    ASSERT_EQ(client.upgrade(), 101U);
    EXPECT_EQ(client.receive(), "hello");
    EXPECT_EQ(client.receive(), scene);
    events.clear();
    for (WebServer::Event event; server.takeEvent(event);) {
      events.push_back(event);
    }
    const auto joined = std::ranges::find(events, WebServer::Event::Kind::kJoined, &WebServer::Event::kind);
    ASSERT_NE(joined, events.end());
    EXPECT_EQ(joined->entrance, entrance);
  }
  EXPECT_THROW(WebServer({.port = 0, .entrances = {{.token = "one"}, {.token = "one"}}}, board), InvalidParameter);
  EXPECT_THROW(WebServer({.port = 0, .entrances = {{.token = "one"}, {}}}, board), InvalidParameter);
}

}  // namespace
}  // namespace haptolith

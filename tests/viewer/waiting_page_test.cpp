#include "haptolith/viewer/waiting_page.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>

#include <string>

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace asio = boost::asio;

std::string pageAt(std::uint16_t port) {
  asio::io_context io;
  asio::ip::tcp::socket socket(io);
  socket.connect({asio::ip::address_v4::loopback(), port});
  asio::write(socket, asio::buffer(std::string("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")));
  std::string text;
  boost::system::error_code end;
  asio::read(socket, asio::dynamic_buffer(text), end);
  return text;
}

TEST(WaitingPage, SaysWhatTheProgramDoesAndReloadsItself) {
  WaitingPage page({.port = 38080});
  ASSERT_NE(page.port(), 0);
  page.say("soil settles, 40 % done");
  EXPECT_THAT(pageAt(page.port()),
              AllOf(HasSubstr("503"), HasSubstr("Refresh: 1"), HasSubstr("soil settles, 40 % done")));
}

TEST(WaitingPage, LeavesItsPortToTheServer) {
  std::uint16_t port = 0;
  {
    const WaitingPage page({.port = 38090});
    port = page.port();
    (void)pageAt(port);
  }
  Board board(std::string("{}"));
  EXPECT_EQ(WebServer({.port = port}, board).port(), port);
}

TEST(WaitingPage, OfAnyPortServesNothing) {
  EXPECT_EQ(WaitingPage({.port = 0}).port(), 0);
}

TEST(SettledFraction, RisesFromNothingToOneAndNeverFalls) {
  SettledFraction fraction;
  EXPECT_EQ(fraction.update(0.1), 0);
  EXPECT_NEAR(fraction.update(0.01), 1.0 / 3, 1e-9);
  EXPECT_GE(fraction.update(0.05), 1.0 / 3);
  EXPECT_EQ(fraction.update(0), 1);
}

}  // namespace
}  // namespace haptolith

#include "haptolith/viewer/access.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace haptolith {
namespace {

TEST(Access, KnowsTheAddressesThatOnlyThisMachineReaches) {
  for (const char* here : {"127.0.0.1", "127.1.2.3", "::1", "localhost", "LocalHost"}) {
    EXPECT_TRUE(isLoopback(here)) << here;
  }
  for (const char* elsewhere : {"0.0.0.0", "::", "192.168.0.1", "127.evil.com", "127.0.0.1.evil.com", "127.0.0",
                                "127.0.0.", "127.0.0.256", "127.0.0.1234", "", "localhost.evil.com"}) {
    EXPECT_FALSE(isLoopback(elsewhere)) << elsewhere;
  }
}

TEST(Access, ReadsTheNameInAHostHeader) {
  for (const char* here : {"localhost", "localhost:8080", "127.0.0.1:1", "[::1]", "[::1]:8080"}) {
    EXPECT_TRUE(namesLoopback(here)) << here;
  }
  for (const char* elsewhere : {"evil.com", "evil.com:8080", "", ":8080", "[::1", "[::1]evil.com", "[::2]:8080",
                                "localhost.evil.com:80", "evil.com#localhost"}) {
    EXPECT_FALSE(namesLoopback(elsewhere)) << elsewhere;
  }
}

TEST(Access, APageFromElsewhereIsKnownByItsOrigin) {
  EXPECT_TRUE(isFromHere("http://localhost:8080", "localhost:8080"));
  EXPECT_TRUE(isFromHere("https://Lab.example:8443", "lab.example:8443"));
  EXPECT_FALSE(isFromHere("http://evil.com", "localhost:8080"));
  EXPECT_FALSE(isFromHere("http://localhost:8081", "localhost:8080"));
  EXPECT_FALSE(isFromHere("http://localhost:8080.evil.com", "localhost:8080"));
  EXPECT_FALSE(isFromHere("null", "localhost:8080"));  // a file, a sandboxed frame
  EXPECT_FALSE(isFromHere("http://", ""));
  EXPECT_FALSE(isFromHere("", ""));
}

TEST(Access, FindsTheTokenInATarget) {
  EXPECT_EQ(tokenOf("/?token=abc"), "abc");
  EXPECT_EQ(tokenOf("/ws?view=top&token=abc&x=1"), "abc");
  EXPECT_EQ(tokenOf("/ws?mytoken=abc"), "");
  EXPECT_EQ(tokenOf("/ws?token="), "");
  EXPECT_EQ(tokenOf("/token=abc"), "");
  EXPECT_EQ(tokenOf(""), "");
}

TEST(Access, TokensAreComparedWhole) {
  EXPECT_TRUE(sameToken("abc", "abc"));
  EXPECT_FALSE(sameToken("abc", "abd"));
  EXPECT_FALSE(sameToken("abc", "ab"));
  EXPECT_FALSE(sameToken("", "abc"));
}

TEST(Access, NewTokensAreLongAndDiffer) {
  const std::string token = newToken();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_TRUE(std::ranges::all_of(token, [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }));
  EXPECT_NE(token, newToken());
}

}  // namespace
}  // namespace haptolith

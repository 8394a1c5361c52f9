#include "haptolith/viewer/access.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "haptolith/core/error.h"

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
  for (const char* here :
       {"localhost", "localhost:8080", "localhost.", "localhost.:8080", "127.0.0.1:1", "[::1]", "[::1]:8080"}) {
    EXPECT_TRUE(namesLoopback(here)) << here;
  }
  for (const char* elsewhere : {"evil.com", "evil.com:8080", "", ":8080", "[::1", "[::1]evil.com", "[::2]:8080",
                                "localhost.evil.com:80", "evil.com#localhost", "localhost..", ".", "evil.com."}) {
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

TEST(Access, ATokenThatIsEasyToGuessOrThatNoAddressCanHoldIsRefusedWithoutTellingIt) {
  EXPECT_NO_THROW(requireGoodToken("ABCxyz_-01234567", "token"));
  EXPECT_NO_THROW(requireGoodToken(newToken(), "token"));
  for (const std::string& bad :
       {std::string(), std::string("x"), std::string(15, 'x'), std::string(129, 'x'), std::string("secret with spaces"),
        std::string("secret&secret&secret"), std::string("secret%20secret%20"),
        std::string("s\xc3\xa4"
                    "cret_secret_secret"),
        std::string("secret_secret_se\0", 17)}) {
    try {
      requireGoodToken(bad, "token");
      ADD_FAILURE() << bad;
    } catch (const InvalidParameter& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("16 to 128 of A to Z"));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("secret")));
    }
  }
}

TEST(Access, NewTokensAreLongAndDiffer) {
  const std::string token = newToken();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_TRUE(std::ranges::all_of(token, [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }));
  EXPECT_NE(token, newToken());
}

}  // namespace
}  // namespace haptolith

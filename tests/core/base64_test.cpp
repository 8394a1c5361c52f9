#include "haptolith/core/base64.h"

#include <gtest/gtest.h>

#include <random>

namespace haptolith {
namespace {

TEST(Base64, GivesTheLettersOfTheStandardAndReadsThem) {
  // RFC 4648, section 10.
  const std::pair<std::string, std::string> examples[]{{"", ""},
                                                       {"f", "Zg=="},
                                                       {"fo", "Zm8="},
                                                       {"foo", "Zm9v"},
                                                       {"foob", "Zm9vYg=="},
                                                       {"fooba", "Zm9vYmE="},
                                                       {"foobar", "Zm9vYmFy"},
                                                       {std::string("\xff\xfe\x00", 3), "//4A"}};
  for (const auto& [bytes, text] : examples) {
    EXPECT_EQ(base64(bytes), text);
    EXPECT_EQ(fromBase64(text), bytes);
    EXPECT_EQ(fromBase64(text.substr(0, text.find('='))), bytes) << "without padding";
  }
}

TEST(Base64, OfAnyBytesComesBack) {
  std::mt19937 random(1);
  for (std::size_t size = 0; size < 100; ++size) {
    std::string bytes(size, '\0');
    for (char& byte : bytes) {
      byte = static_cast<char>(random());
    }
    EXPECT_EQ(fromBase64(base64(bytes)), bytes);
  }
}

TEST(Base64, WhatIsNoneIsRefused) {
  for (const char* text : {"Z", "Zm9vY", "Zm9*", "Zm 9v", "Zg===", "=Zg=", "Zm9v\n"}) {
    EXPECT_EQ(fromBase64(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace haptolith

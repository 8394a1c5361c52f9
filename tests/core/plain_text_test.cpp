#include "haptolith/core/plain_text.h"

#include <gmock/gmock.h>

#include <string>

namespace haptolith {
namespace {

TEST(PlainText, LeavesLettersOfAnyLanguageAlone) {
  const std::string text = "Mondboden 35° ± 0.9 μm, 月, 🌒 \\ ' \"";
  EXPECT_EQ(plainText(text), text);
  EXPECT_TRUE(isPlainText(text));
}

TEST(PlainText, ShowsWhatATerminalWouldObey) {
  EXPECT_EQ(plainText("a\033]0;title\007b"), "a\\u001b]0;title\\u0007b");
  EXPECT_EQ(plainText("\xC2\x9B"
                      "31m"),
            "\\u009b31m");  // CSI as one letter
  EXPECT_EQ(plainText("a\nb\tc\rd"), "a\\u000ab\\u0009c\\u000dd");
  EXPECT_EQ(plainText("a\nb\tc\rd", Lines::kSeveral), "a\nb\tc\\u000dd");
  EXPECT_EQ(plainText("\xE2\x80\xAEtxt.exe"), "\\u202etxt.exe");
  EXPECT_FALSE(isPlainText("\x7F"));
  EXPECT_FALSE(isPlainText("two\nlines"));
  EXPECT_TRUE(isPlainText("two\nlines", Lines::kSeveral));
}

TEST(PlainText, HasNoControlCharacterWhateverTwoBytesItIsGiven) {
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const std::string text{static_cast<char>(first), static_cast<char>(second)};
      const std::string plain = plainText(text);
      for (const char letter : plain) {
        const auto byte = static_cast<unsigned char>(letter);
        ASSERT_TRUE(byte >= 0x20 && byte != 0x7F) << first << ' ' << second;
      }
      ASSERT_TRUE(isPlainText(plain)) << first << ' ' << second;
      ASSERT_EQ(isPlainText(text), plain == text) << first << ' ' << second;
    }
  }
}

TEST(PlainText, WhatIsNotUtf8IsReplaced) {
  for (const char* bytes : {"\xFF", "\xC0\x80", "\xED\xA0\x80", "\xF5\x80\x80\x80", "\xE2\x82"}) {
    EXPECT_THAT(plainText(bytes), testing::StartsWith("\xEF\xBF\xBD")) << bytes;
    EXPECT_FALSE(isPlainText(bytes));
  }
}

TEST(PlainText, AQuoteShowsWhatCannotBeSeen) {
  EXPECT_EQ(inQuotes("0.5\xC2\xA0"), "'0.5\\u00a0'");
  EXPECT_EQ(inQuotes("\xE2\x88\x92"
                     "1"),
            "'\\u22121'");
  EXPECT_EQ(inQuotes("\xEF\xBB\xBFx\xE2\x80\x8B"), "'\\ufeffx\\u200b'");
  EXPECT_EQ(plainText("0.5\xC2\xA0"), "0.5\xC2\xA0") << "a space as others, elsewhere";
}

TEST(PlainText, AQuoteIsCutBetweenLettersAndSaysSo) {
  EXPECT_EQ(inQuotes("title"), "'title'");
  EXPECT_EQ(inQuotes("a\nb"), "'a\\u000ab'");
  EXPECT_EQ(inQuotes("μμμ", 2), "'μμ...'");
  EXPECT_EQ(inQuotes(std::string(1 << 20, 'x')).size(), kQuoteLetters + 5);
}

}  // namespace
}  // namespace haptolith

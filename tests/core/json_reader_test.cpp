#include "haptolith/core/files/json_reader.h"

#include <gmock/gmock.h>

#include <functional>
#include <string>

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string refusal(const std::function<void()>& read) {
  try {
    read();
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "accepted";
}

JsonValue parsed(std::string_view text, const std::string& name = "a.json", const JsonLimits& limits = {}) {
  return parseJson(text, name, "a mesh", limits);
}

TEST(JsonReader, ReadsEveryKindOfValue) {
  const JsonValue root = parsed(
      R"({"number": 0.5, "whole": 7, "text": "ä", "flag": true, "none": null, "list": [1, 2, 3], "object": {"b": 1, "a": 2}})");
  EXPECT_EQ(root.at("number").number({0, 1}), 0.5);
  EXPECT_EQ(root.at("whole").number({0, 10}), 7);
  EXPECT_EQ(root.at("whole").whole(7), 7U);
  EXPECT_EQ(root.at("text").text(), "ä");
  EXPECT_TRUE(root.at("flag").flag());
  EXPECT_TRUE(root.has("none"));
  EXPECT_FALSE(root.has("nothing"));
  EXPECT_FALSE(root.find("nothing"));
  EXPECT_EQ(root.at("list").numbers<3>({1, 3}), (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ(root.at("list").list().at(2).whole(9), 3U);
  ASSERT_EQ(root.at("object").members().size(), 2U);
  EXPECT_EQ(root.at("object").members()[0].first, "a");
  EXPECT_EQ(root.at("object").members()[0].second.whole(9), 2U);
}

TEST(JsonReader, RefusesOtherTypesAndRangesWithThePath) {
  const JsonValue root = parsed(R"({"a": {"b": [1, -2, 1.5, "x\u001b", null, 1e300, {}, [1]]}})");
  const JsonValue list = root.at("a").at("b");
  EXPECT_EQ(list.path(), "a.json: a.b");
  EXPECT_EQ(refusal([&] { (void)list.at(0).number({2, 3}); }), "a.json: a.b[0] = 1 is not valid: must be 2 to 3");
  EXPECT_THAT(refusal([&] { (void)list.at(0).whole(0); }),
              HasSubstr("a.b[0] = 1 is not valid: must be a whole number from 0 to 0"));
  EXPECT_THAT(refusal([&] { (void)list.at(1).whole(9); }), HasSubstr("a.b[1] = -2"));
  EXPECT_THAT(refusal([&] { (void)list.at(2).whole(9); }), HasSubstr("a.b[2] = 1.5"));
  EXPECT_THAT(refusal([&] { (void)list.at(3).number({}); }),
              HasSubstr("a.b[3] = 'x\\u001b' is not valid: must be a number"));
  EXPECT_THAT(refusal([&] { (void)list.at(4).text(); }), HasSubstr("a.b[4] = null is not valid: must be a text"));
  EXPECT_THAT(refusal([&] { (void)list.at(5).whole(9); }), HasSubstr("a whole number"));
  EXPECT_THAT(refusal([&] { (void)list.at(6).flag(); }), HasSubstr("an object is not valid: must be true or false"));
  EXPECT_THAT(refusal([&] { (void)list.at(7).members(); }), HasSubstr("a list of 1 is not valid: must be an object"));
  EXPECT_THAT(refusal([&] { (void)list.at(8); }), HasSubstr("a.b = without 8"));
  EXPECT_THAT(refusal([&] { (void)list.list(2, 3); }),
              HasSubstr("a.b = a list of 8 is not valid: must be a list of 2 to 3"));
  EXPECT_THAT(refusal([&] { (void)list.numbers<3>({}); }), HasSubstr("a list of 8 is not valid: must be 3 numbers"));
  EXPECT_THAT(refusal([&] { (void)list.at(6).at("c"); }), HasSubstr("a.b[6].c is missing"));
  EXPECT_THAT(refusal([&] { (void)list.at("c"); }), HasSubstr("an object"));
}

TEST(JsonReader, RefusesKeysThatWereNotRead) {
  const JsonValue root = parsed(R"({"a": 1, "b": 2, "c": 3})", "");
  (void)root.at("a");
  (void)root.find("b");
  EXPECT_EQ(refusal([&] { root.refuseOtherKeys(); }), "c is not known: remove this key");
  (void)root.members();
  EXPECT_EQ(refusal([&] { root.refuseOtherKeys(); }), "accepted");
}

TEST(JsonReader, RefusesWhatIsNoObjectOrExceedsItsLimits) {
  const auto parse = [](std::string_view text, const JsonLimits& limits = {}) {
    return refusal([&] { (void)parsed(text, "a.json", limits); });
  };
  EXPECT_EQ(parse(R"({"a": })"), "a.json = not JSON at byte 7 is not valid: must be a mesh");
  EXPECT_THAT(parse(""), HasSubstr("not JSON"));
  EXPECT_THAT(parse(R"({"a": 1e999})"), HasSubstr("not JSON"));
  EXPECT_THAT(parse("{\"a\": \"\xff\"}"), HasSubstr("not JSON"));
  EXPECT_EQ(parse("[1, 2]"), "a.json = a list of 2 is not valid: must be a mesh");
  EXPECT_EQ(parse(R"({"a": [[]]})", {.depth = 3}), "accepted");
  EXPECT_THAT(parse(R"({"a": [[]]})", {.depth = 2}), AllOf(HasSubstr("more than 2 deep"), HasSubstr("a mesh")));
  EXPECT_THAT(parse(std::string(1'000'000, '[')), HasSubstr("more than 32 deep"));
  EXPECT_EQ(parse(R"({"a": [1, 2]})", {.values = 5}), "accepted") << "the object, a key, the list and its numbers";
  EXPECT_THAT(parse(R"({"a": [1, 2]})", {.values = 4}), HasSubstr("at most 4 values"));
}

}  // namespace
}  // namespace haptolith

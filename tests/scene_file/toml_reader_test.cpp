#include "haptolith/scene_file/toml/toml_reader.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace haptolith {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr FileKind kRecipes{
    .name = "recipe", .example_key = "title", .document = "docs/recipes.md", .left_out = "left out, so the cook's"};

struct Recipe {
  std::string title;
  double salt_kg = 0;
  std::int64_t eggs = 0;
  Vec3 tin_m = Vec3::Zero();
  Range heat_k = {};
  bool vegan = false;
  std::string oven;
  std::vector<TextOrNumber> extras;
};
using Key = FileKey<Recipe>;

const std::vector<Key> kKeys{
    {"", "title", "", Key::TextValue{[](Recipe& r, std::string_view v) { r.title = v; }, kOnlyRead}, ""},
    {"", "salt_g", "salt_kg", Key::NumberValue{{0, 50}, [](Recipe& r, double v) { r.salt_kg = v / 1000; }, kOnlyRead},
     ""},
    {"dough", "eggs", "", Key::CountValue{{0, 12}, [](Recipe& r, std::int64_t v) { r.eggs = v; }, kOnlyRead}, ""},
    {"dough", "tin_m", "", Key::VectorValue{{0, 1}, [](Recipe& r, const Vec3& v) { r.tin_m = v; }, kOnlyRead}, ""},
    {"dough", "heat_k", "", Key::IntervalValue{{273, 600}, [](Recipe& r, const Range& v) { r.heat_k = v; }, kOnlyRead},
     ""},
    {"dough", "vegan", "", Key::SwitchValue{[](Recipe& r, bool v) { r.vegan = v; }, kOnlyRead}, ""},
    {"dough", "oven", "",
     Key::WordValue{{"gas", "electric"}, [](Recipe& r, std::string_view v) { r.oven = v; }, kOnlyRead}, ""},
    {"dough", "extras", "",
     Key::ItemsValue{"nuts or grams", [](Recipe& r, const std::vector<TextOrNumber>& v) { r.extras = v; }}, ""},
};

TomlReader reader(std::string_view text) {
  return {"cake.toml", text, kRecipes};
}

Recipe recipe(const TomlReader& from) {
  Recipe read;
  from.refuseUnknownKeys(keyNames(std::span<const Key>(kKeys)));
  for (const Key& key : kKeys) {
    from.apply(key, read);
  }
  return read;
}

template <class Read>
std::string refusal(const Read& read) {
  try {
    read();
  } catch (const TomlError& error) {
    return error.what();
  }
  return "accepted";
}

std::string refused(const std::string& text) {
  return refusal([&] { (void)recipe(reader(text)); });
}

TEST(TomlReader, ReadsEveryKindOfValue) {
  const Recipe read =
      recipe(reader("title = \"Cake\"\nsalt_g = 5\n[dough]\neggs = 3\ntin_m = [0.3, 1, 0.1]\nheat_k = [400, 450.5]\n"
                    "vegan = false\noven = \"Gas\"\nextras = [\"nuts\", 20]\n"));
  EXPECT_EQ(read.title, "Cake");
  EXPECT_EQ(read.salt_kg, 0.005);
  EXPECT_EQ(read.eggs, 3);
  EXPECT_EQ(read.tin_m, Vec3(0.3, 1, 0.1));
  EXPECT_EQ(read.heat_k.highest, 450.5);
  EXPECT_EQ(read.oven, "gas") << "in any case";
  ASSERT_EQ(read.extras.size(), 2U);
  EXPECT_EQ(read.extras[0].text, "nuts");
  EXPECT_EQ(read.extras[1].number, 20);
}

TEST(TomlReader, RefusesAValueWithFileLineKeyAndRange) {
  EXPECT_EQ(refused("title = \"Cake\"\nsalt_g = 51\n"), "cake.toml:2: salt_g = 51 is not valid: must be 0 to 50");
  EXPECT_THAT(refused("salt_g = \"much\""), HasSubstr("salt_g = 'much' is not valid: must be a number, 0 to 50"));
  EXPECT_THAT(refused("salt_g = nan"), HasSubstr("salt_g"));
  EXPECT_THAT(refused("salt_g = 0.69999999999999996e2"), HasSubstr("salt_g = 70.0"));
  EXPECT_THAT(refused("title = \"\""), HasSubstr("not empty"));
  EXPECT_THAT(refused("title = \"a\\u001bb\""), AllOf(HasSubstr("\\u001b"), HasSubstr("control characters")));
  EXPECT_THAT(refused("title = \"" + std::string(201, 'x') + "\""), HasSubstr("at most 200 bytes long, not 201"));
  EXPECT_THAT(refused("[dough]\neggs = 1.5"), HasSubstr("cake.toml:2: [dough] eggs = 1.5"));
  EXPECT_THAT(refused("[dough]\ntin_m = [1, 2]"), HasSubstr("three numbers"));
  EXPECT_THAT(refused("[dough]\nheat_k = [450, 400]"), HasSubstr("the smaller first"));
  EXPECT_THAT(refused("[dough]\nvegan = 1"), HasSubstr("true or false"));
  EXPECT_THAT(refused("[dough]\noven = \"elektric\""), HasSubstr("gas or electric; did you mean electric?"));
  EXPECT_THAT(refused("[dough]\nextras = [true]"), HasSubstr("nuts or grams"));
  EXPECT_THAT(refused("dough = 1"), HasSubstr("dough = 1 is not valid: must be a table, [dough]"));
}

TEST(TomlReader, RefusesKeysThatItDoesNotKnowAndSuggestsOne) {
  EXPECT_THAT(refused("titel = \"Cake\""), HasSubstr("cake.toml:1: titel is not known; did you mean title?"));
  EXPECT_THAT(refused("[doug]\neggs = 1"), HasSubstr("did you mean [dough]?"));
  EXPECT_THAT(refused("eggs = 1"), HasSubstr("did you mean [dough] eggs?"));
  EXPECT_THAT(refused("[dough]\nzzzzzzz = 1"), HasSubstr("see docs/recipes.md"));
}

TEST(TomlReader, RefusesWhatIsNoTomlOrEmpty) {
  EXPECT_THAT(refused("title = \"Cake\"\nsalt_g = = 1"), HasSubstr("cake.toml:2: not TOML"));
  EXPECT_THAT(refused("title = 1\ntitle = 2"), HasSubstr("not TOML"));
  EXPECT_THAT(refused("# nothing\n"), HasSubstr("a recipe has at least one key, for example title (docs/recipes.md)"));
  EXPECT_THAT(refusal([] { (void)TomlReader("no-such-file.toml", kRecipes); }), HasSubstr("no such file"));
}

TEST(TomlReader, TakesOverridesBeforeTheFileAndDropsTheirRivals) {
  TomlReader from = reader("salt_g = 1\ntitle = \"Cake\"\n");
  const std::vector<std::string> overrides{"dough.eggs=4", "title=Tart", "salt_g = 2"};
  const std::vector<RivalKeys> rivals{{"", "salt_g", "title"}};
  from.takeOverrides(overrides, {});
  EXPECT_EQ(recipe(from).eggs, 4);
  EXPECT_EQ(recipe(from).title, "Tart") << "what is no TOML is text";
  EXPECT_EQ(recipe(from).salt_kg, 0.002);
  TomlReader other = reader("salt_g = 1\ntitle = \"Cake\"\n");
  other.takeOverrides(std::vector<std::string>{"salt_g=2"}, rivals);
  EXPECT_EQ(recipe(other).title, "");
  EXPECT_THAT(refusal([&] { from.takeOverrides(std::vector<std::string>{"eggs"}, {}); }), HasSubstr("table.key=value"));
  from.takeOverrides(std::vector<std::string>{"salt_g=60"}, {});
  EXPECT_THAT(refusal([&] { (void)recipe(from); }), HasSubstr("override salt_g=60: salt_g = 60"));
}

TEST(TomlReader, ReadsThePartsOfAListEachAsAFile) {
  const TomlReader whole = reader("[[layer]]\nsalt_g = 1\n\n[[layer]]\nsalt_g = 70\n");
  const std::vector<TomlReader> parts = whole.parts("layer");
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(recipe(parts[0]).salt_kg, 0.001);
  EXPECT_EQ(parts[1].line(), 4);
  EXPECT_THAT(refusal([&] { (void)recipe(parts[1]); }), HasSubstr("cake.toml:5: [[layer]] salt_g = 70"));
  EXPECT_TRUE(whole.parts("none").empty());
  EXPECT_THAT(refusal([] { (void)reader("layer = 1").parts("layer"); }), HasSubstr("tables, each under [[layer]]"));
  EXPECT_THAT(refusal([&] { parts[0].require("", "title"); }), HasSubstr("cake.toml:1: [[layer]] title is missing"));
}

TEST(TomlReader, ChecksValuesAgainstEachOtherInTheUnitOfTheKey) {
  const auto too_much = [] { requireInRange("salt_kg", 0.04, {0, 0.01}); };
  const auto check = [&](std::string_view text) {
    return refusal([&] { reader(text).check(std::span<const Key>(kKeys), "", too_much); });
  };
  EXPECT_THAT(check("salt_g = 40"), HasSubstr("cake.toml:1: salt_g = 40 is not valid"));
  EXPECT_THAT(check("title = \"Cake\""), AllOf(HasSubstr("salt_g"), HasSubstr("left out, so the cook's")));
  EXPECT_THAT(refusal([] { reader("[dough]\neggs = 1\nvegan = true").refuseBoth("dough", "eggs", "vegan"); }),
              HasSubstr("cake.toml:3: [dough] eggs and vegan cannot both be given"));
}

}  // namespace
}  // namespace haptolith

#include "haptolith/scene_file/scene_file_keys.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/stone_keys.h"
#include "haptolith/scene_file/tool_part_keys.h"

#include "../source_dir.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

std::string readSource(const std::string& name) {
  std::ifstream file(sourceDir() / name);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The pages that list the keys of scenes, one after the other.
std::string readKeyPages() {
  std::string text;
  for (const std::string_view page : {"scenes", "scene-keys-soil", "scene-keys-tool", "scene-keys-loop"}) {
    text += readSource(fmt::format("docs/reference/{}.md", page));
  }
  return text;
}

/// The row for a key in these pages.
template <class Key>
std::string documented(const Key& key) {
  return fmt::format("| `{}` | {} | {} |\n", key.name, validText(key), key.meaning);
}

TEST(SceneFileKeys, AreAllInTheDocument) {
  const std::string document = readKeyPages();
  for (const SceneFileKey& key : sceneFileKeys()) {
    const std::size_t section =
        document.find(key.table.empty() ? "## At the top\n" : fmt::format("## [{}]\n", key.table));
    ASSERT_NE(section, std::string::npos) << "no section for " << key.table;
    const std::string text = document.substr(section, document.find("\n## ", section + 1) - section);
    EXPECT_THAT(text, HasSubstr(documented(key)));
  }
}

TEST(SceneFileKeys, OfAStoneAreAllInTheDocument) {
  const std::string document = readKeyPages();
  const std::string text = document.substr(document.find("## [[stone]]\n"));
  for (const StoneKey& key : stoneKeys()) {
    EXPECT_THAT(text, HasSubstr(documented(key)));
  }
}

TEST(SceneFileKeys, OfAToolsPartAreAllInTheDocument) {
  const std::string document = readKeyPages();
  const std::string text = document.substr(document.find("## [[tool_part]]\n"));
  for (const ToolPartKey& key : toolPartKeys()) {
    EXPECT_THAT(text, HasSubstr(documented(key)));
  }
}

TEST(SceneFileKeys, TheDocumentHasNoOthers) {
  const std::string document = readKeyPages();
  std::ptrdiff_t rows = 0;
  for (std::size_t at = document.find("\n| `"); at != std::string::npos; at = document.find("\n| `", at + 1)) {
    ++rows;
  }
  EXPECT_EQ(rows, std::ssize(sceneFileKeys()) + std::ssize(stoneKeys()) + std::ssize(toolPartKeys()));
}

TEST(SceneFileKeys, AreAllInThePapersScene) {
  const std::string scene = readSource("scenes/icra2021.toml");
  for (const SceneFileKey& key : sceneFileKeys()) {
    EXPECT_THAT(scene, HasSubstr(std::string(key.name) + " = "));
  }
}

TEST(SceneFileKeys, SayWhatIsValid) {
  const auto valid = [](std::string_view table, std::string_view name) {
    for (const SceneFileKey& key : sceneFileKeys()) {
      if (key.table == table && key.name == name) {
        return validText(key);
      }
    }
    return std::string("no such key");
  };
  EXPECT_EQ(valid("soil", "preset"), "P1, P2, P3, P4, P5 or P6");
  EXPECT_EQ(valid("soil", "gamma_nm"), "> 0");
  EXPECT_EQ(valid("bed", "layers"), "a whole number, 1 to 1000");
  EXPECT_EQ(valid("hand", "home_mm"), "three numbers, each -10000 to 10000");
  EXPECT_EQ(valid("loop", "real_time"), "true or false");
}

// --- what a key accepts, the parameters accept, and the reverse ------------------------------------------------------

/// A scene in which every number of the key's table is checked.
SceneFile sceneFor(const SceneFileKey& key) {
  SceneFile scene;
  scene.bed.start = key.name == "depth_mm" ? BedStart::kPacked
                    : key.name == "seed"   ? BedStart::kRain
                                           : BedStart::kCount;
  scene.tool.joint.drive = key.name == "joint_inertia_kg_m2" ? Drive::kFree : Drive::kNone;
  return scene;
}

/// Gives the key a number, three times the same for a vector; gravity has one axis. False for a key without a range.
bool give(const SceneFileKey& key, SceneFile& scene, double number) {
  if (const auto* value = std::get_if<SceneFileKey::NumberValue>(&key.value)) {
    value->set(scene, number);
  } else if (const auto* count = std::get_if<SceneFileKey::CountValue>(&key.value)) {
    count->set(scene, static_cast<std::int64_t>(number));
  } else if (const auto* vector = std::get_if<SceneFileKey::VectorValue>(&key.value)) {
    vector->set(scene, key.table == "gravity" ? Vec3(0, 0, number) : Vec3(Vec3::Constant(number)));
  } else {
    return false;
  }
  return true;
}

std::optional<Range> rangeOf(const SceneFileKey& key) {
  const auto range = [](const auto& value) -> std::optional<Range> {
    if constexpr (requires { value.valid.lowest; }) {
      return value.valid;
    } else {
      return std::nullopt;
    }
  };
  return std::visit(range, key.value);
}

void checkTable(const SceneFile& scene, std::string_view table) {
  if (table == "soil") {
    validate(scene.bed.soil);
  } else if (table == "tool") {
    validate(scene.mesh);
    validate(scene.tool);
  } else if (table == "hand") {
    validate(scene.hand);
  } else if (table == "loop") {
    validate(scene.loop);
  } else if (table == "device") {
    validate(scene.device);
  } else if (table == "mapping") {
    validate(scene.handling.mapping);
  } else if (table == "coupling") {
    validate(scene.handling.coupling, scene.loop.tick_s);
  } else if (table == "safety") {
    validate(scene.handling.safety);
  } else {
    validate(scene.bed);
  }
}

/// Whether the parameters take this number of this key; another parameter may mind it.
bool accepts(const SceneFileKey& key, double number) {
  SceneFile scene = sceneFor(key);
  give(key, scene, number);
  try {
    checkTable(scene, key.table);
  } catch (const InvalidParameter& error) {
    return error.key() != key.parameter;
  }
  return true;
}

/// A little outside: the next whole number for counts.
double outside(double end, double direction) {
  return end + direction * std::max(1.0, std::abs(end)) * 0.001 + (end > 1e15 ? direction * 1e13 : 0);
}

TEST(SceneFileKeys, AcceptWhatTheParametersAcceptAtBothEnds) {
  // Other parts of the scene make these narrower: a box is at least a particle wide, a spring's mass follows it.
  constexpr std::array<std::string_view, 5> kNarrower{"width_mm", "length_mm", "depth_mm", "rho_max_kg_m3", "mass_kg"};
  for (const SceneFileKey& key : sceneFileKeys()) {
    const std::optional<Range> range = rangeOf(key);
    // Directions have no magnitude, and of the finest grains only halves of the soil's are taken.
    if (!range || key.name == "direction" || key.name == "joint_axis" || key.name == "fine_radius_mm") {
      continue;
    }
    SCOPED_TRACE(fmt::format("[{}] {}: {}", key.table, key.name, range->text()));
    const bool is_count = std::holds_alternative<SceneFileKey::CountValue>(key.value);
    if (std::isfinite(range->lowest)) {
      const bool closed = range->ends == Ends::kClosed;
      const bool narrower = std::ranges::find(kNarrower, key.name) != kNarrower.end();
      EXPECT_TRUE(narrower || accepts(key, range->lowest) == closed);
      const bool unsigned_there = (is_count && range->lowest == 0) || key.name == "magnitude_m_s2";
      EXPECT_TRUE(unsigned_there || !accepts(key, is_count ? range->lowest - 1 : outside(range->lowest, -1)));
    }
    if (std::isfinite(range->highest)) {
      EXPECT_EQ(accepts(key, range->highest), range->ends != Ends::kOpen);
      EXPECT_FALSE(accepts(key, is_count ? std::floor(outside(range->highest, 1)) + 1 : outside(range->highest, 1)));
    }
  }
}

TEST(SceneFileKeys, HaveTheRangeOfTheParametersInTheirOwnUnit) {
  for (const SceneFileKey& key : sceneFileKeys()) {
    if (key.table == "tool" && key.name == "diameter_mm") {
      EXPECT_EQ(validText(key), "0.01 to 10000");
    } else if (key.name == "turn_deg") {
      EXPECT_EQ(validText(key), "three numbers, each -360 to 360");
    } else if (key.name == "delay_ms") {
      EXPECT_EQ(validText(key), "0 to 30");
    }
  }
}

}  // namespace
}  // namespace haptolith

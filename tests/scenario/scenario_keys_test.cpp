#include "haptolith/scenario/scenario_keys.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

#include "../source_dir.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

std::string readSource(const std::string& name) {
  std::ifstream file(sourceDir() / name);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The row of docs/scenarios.md for a key.
std::string documented(const ScenarioKey& key) {
  return fmt::format("| `{}` | {} | {} |\n", key.name, validText(key), key.meaning);
}

TEST(ScenarioKeys, AreAllInTheDocument) {
  const std::string document = readSource("docs/scenarios.md");
  for (const ScenarioKey& key : scenarioKeys()) {
    const std::size_t section =
        document.find(key.table.empty() ? "## At the top\n" : fmt::format("## [{}]\n", key.table));
    ASSERT_NE(section, std::string::npos) << "no section for " << key.table;
    const std::string text = document.substr(section, document.find("\n## ", section + 1) - section);
    EXPECT_THAT(text, HasSubstr(documented(key)));
  }
}

TEST(ScenarioKeys, TheDocumentHasNoOthers) {
  const std::string document = readSource("docs/scenarios.md");
  std::ptrdiff_t rows = 0;
  for (std::size_t at = document.find("\n| `"); at != std::string::npos; at = document.find("\n| `", at + 1)) {
    ++rows;
  }
  EXPECT_EQ(rows, std::ssize(scenarioKeys()));
}

TEST(ScenarioKeys, AreAllInThePapersScene) {
  const std::string scene = readSource("scenarios/paper.toml");
  for (const ScenarioKey& key : scenarioKeys()) {
    EXPECT_THAT(scene, HasSubstr(std::string(key.name) + " = "));
  }
}

TEST(ScenarioKeys, SayWhatIsValid) {
  const auto valid = [](std::string_view table, std::string_view name) {
    for (const ScenarioKey& key : scenarioKeys()) {
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
  EXPECT_EQ(valid("loop", "paced"), "true or false");
}

}  // namespace
}  // namespace haptolith

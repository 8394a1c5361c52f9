#include "messy_inputs.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Readers = std::map<std::string, std::function<Reading(const fs::path&)>>;

Expectation expectationFrom(const std::string& text) {
  Expectation expected;
  std::istringstream stream(text);
  stream >> expected.input >> expected.verb;
  if (expected.verb == "is") {
    stream >> expected.clean;
  } else if (expected.verb == "warned" || expected.verb == "refused") {
    stream >> expected.line >> std::ws;
    std::getline(stream, expected.words);
  }
  EXPECT_TRUE(!expected.clean.empty() || !expected.words.empty()) << "no expectation: " << text;
  return expected;
}

}  // namespace

std::vector<Expectation> expectationsIn(const fs::path& folder) {
  std::ifstream file(folder / "expectations.txt");
  std::vector<Expectation> all;
  std::set<std::string> named{"expectations.txt"};
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.starts_with('#')) {
      continue;
    }
    all.push_back(expectationFrom(line));
    named.insert({all.back().input, all.back().clean});
  }
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    const bool buffer = entry.path().extension() == ".bin";  // buffer of a glTF file
    EXPECT_TRUE(entry.is_directory() || buffer || named.contains(name)) << name << " is not in expectations.txt";
  }
  return all;
}

void expectWords(const std::string& message, const Expectation& expected) {
  EXPECT_THAT(message, HasSubstr(expected.words));
  if (expected.line > 0) {
    EXPECT_TRUE(std::regex_search(message, std::regex(fmt::format(":{}([^0-9]|$)", expected.line)))) << message;
  }
}

void expectAsWritten(const Expectation& expected, const std::function<std::string()>& read) {
  SCOPED_TRACE(fmt::format("{} {} {}{}", expected.input, expected.verb, expected.clean, expected.words));
  try {
    const std::string warnings = read();
    EXPECT_NE(expected.verb, "refused") << "read without complaint";
    if (expected.verb == "warned") {
      expectWords(warnings, expected);
    }
  } catch (const InvalidParameter& error) {
    EXPECT_EQ(expected.verb, "refused") << error.what();
    if (expected.verb == "refused") {
      expectWords(error.what(), expected);
    }
  }
}

void expectAsWritten(const fs::path& folder, const Readers& readers, int fewest) {
  std::map<std::string, int> counts;
  for (const Expectation& expected : expectationsIn(folder)) {
    const std::string name = fs::path(expected.input).begin()->string();
    ++counts[name];
    expectAsWritten(expected, [&] {
      const Reading reading = readers.at(name)(folder / expected.input);
      if (!expected.clean.empty()) {
        EXPECT_EQ(reading.text, readers.at(name)(folder / expected.clean).text);
      }
      return reading.warnings;
    });
  }
  for (const auto& [name, reader] : readers) {
    EXPECT_GE(counts[name], fewest) << name;
  }
}

}  // namespace haptolith

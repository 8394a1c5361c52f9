#include "messy_inputs.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <set>
#include <sstream>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Readers = std::map<std::string, std::function<Reading(const fs::path&)>>;

/// A line of expectations.txt.
struct Expectation {
  std::string input, verb;
  std::string clean;  ///< of "is"
  int line = 0;       ///< of "warned" and "refused"
  std::string words = {};
};

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

void expectWords(const std::string& message, const Expectation& expected) {
  EXPECT_THAT(message, HasSubstr(expected.words));
  if (expected.line > 0) {
    EXPECT_THAT(message, HasSubstr(fmt::format(":{}:", expected.line)));
  }
}

void expectOne(const fs::path& folder, const Expectation& expected, const Readers& readers) {
  const std::function<Reading(const fs::path&)>& read = readers.at(*fs::path(expected.input).begin());
  try {
    const Reading reading = read(folder / expected.input);
    if (expected.verb == "is") {
      EXPECT_EQ(reading.text, read(folder / expected.clean).text);
    } else if (expected.verb == "warned") {
      expectWords(reading.warnings, expected);
    } else {
      ADD_FAILURE() << "read without complaint";
    }
  } catch (const InvalidParameter& error) {
    EXPECT_EQ(expected.verb, "refused") << error.what();
    if (expected.verb == "refused") {
      expectWords(error.what(), expected);
    }
  }
}

}  // namespace

void expectAsWritten(const fs::path& folder, const Readers& readers, int fewest) {
  std::ifstream file(folder / "expectations.txt");
  std::map<std::string, int> counts;
  std::set<std::string> named{"expectations.txt"};
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.starts_with('#')) {
      continue;
    }
    const Expectation expected = expectationFrom(line);
    SCOPED_TRACE(line);
    named.insert({expected.input, expected.clean});
    ++counts[*fs::path(expected.input).begin()];
    expectOne(folder, expected, readers);
  }
  for (const auto& [name, reader] : readers) {
    EXPECT_GE(counts[name], fewest) << name;
  }
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    EXPECT_TRUE(entry.is_directory() || named.contains(name)) << name << " is not in expectations.txt";
  }
}

}  // namespace haptolith

#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include "../source_dir.h"

namespace haptolith {
namespace {

/// Words that had several meanings in the public headers, and the words that replace them. A deprecated name may stay,
/// on a line that says so.
struct Word {
  const char* pattern;
  const char* instead;
};
constexpr std::array kRetired{
    Word{"felt", "soil wrench, device wrench or displayed wrench"},
    Word{"let[ _]*go(es)?\\b|takeUp|take_up", "safety trip, release_force, resume_force"},
    Word{"\\bgrains?\\b|macroparticle", "particle"},
    Word{"[^.]\bexchanges?\b", "replace"},
    Word{"[^\"]\\bscenarios?\\b[^\"]", "scene"},  // the key "scenario" of recordings stays
    Word{"\\bpicture", "snapshot or frame"},
};

TEST(PublicHeaders, UseEachWordForOneThing) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(sourceDir() / "include/haptolith")) {
    if (!entry.is_regular_file()) {
      continue;
    }
    ++files;
    std::ifstream file(entry.path());
    int number = 1;
    for (std::string line; std::getline(file, line); ++number) {
      if (line.find("deprecated") != std::string::npos || line.find("HAPTO_RENAMED") != std::string::npos) {
        continue;
      }
      for (const Word& word : kRetired) {
        EXPECT_FALSE(std::regex_search(line, std::regex(word.pattern, std::regex::icase)))
            << entry.path().filename().string() << ':' << number << ": " << line << "\n  instead: " << word.instead;
      }
    }
  }
  EXPECT_GE(files, 6);
}

}  // namespace
}  // namespace haptolith

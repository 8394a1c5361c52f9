#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "source_dir.h"

namespace haptolith {

/// What a reader is to make of a messy input: a line of tests/data/messy/FOLDER/expectations.txt.
struct Expectation {
  std::filesystem::path file;
  std::filesystem::path clean;  ///< the file that it reads as; empty: it is refused
  std::string words;            ///< that the refusal contains
};

/// All of a folder of tests/data/messy, in order.
inline std::vector<Expectation> expectationsOf(const std::string& folder_name) {
  const std::filesystem::path folder = sourceDir() / "tests/data/messy" / folder_name;
  std::ifstream lines(folder / "expectations.txt");
  std::vector<Expectation> all;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string file, verb;
    words >> file >> verb >> std::ws;
    std::string rest;
    std::getline(words, rest);
    if (file.empty() || file.starts_with('#')) {
      continue;
    }
    EXPECT_TRUE((verb == "equals" || verb == "refused") && !rest.empty()) << line;
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << line;
    all.push_back({folder / file, verb == "equals" ? folder / rest : std::filesystem::path(),
                   verb == "equals" ? std::string() : rest});
  }
  return all;
}

}  // namespace haptolith

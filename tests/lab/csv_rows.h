// Reads the measurements in tests/data.
#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "../source_dir.h"

namespace haptolith {

/// The rows of numbers in tests/data/`name`; comments and the line of column names are left out.
inline std::vector<std::vector<double>> csvRows(const std::string& name) {
  std::ifstream file(sourceDir() / "tests" / "data" / name);
  EXPECT_TRUE(file) << name;
  std::vector<std::vector<double>> rows;
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || std::isdigit(static_cast<unsigned char>(line.front())) == 0) {
      continue;
    }
    std::istringstream cells(line);
    std::string cell;
    rows.emplace_back();
    while (std::getline(cells, cell, ',')) {
      rows.back().push_back(std::stod(cell));
    }
  }
  return rows;
}

}  // namespace haptolith

#include "haptolith/psychometrics/levels.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

void requireCounts(const Level& level) {
  requireInRange("x of a level", level.x, {});
  requireInRange("n of a level", level.n, {.lowest = 0});
  requireInRange("k of a level", level.k, {0, level.n});
  for (const double count : {level.k, level.n}) {
    if (count != std::floor(count)) {
      throw InvalidParameter("answers of a level", fmt::format("{}", count), "a whole number");
    }
  }
}

}  // namespace

std::vector<Level> pooled(std::span<const Level> levels) {
  std::map<double, Level> by_x;
  for (const Level& level : levels) {
    requireCounts(level);
    if (level.n > 0) {
      Level& sum = by_x[level.x];
      sum = {level.x, sum.k + level.k, sum.n + level.n};
    }
  }
  std::vector<Level> result;
  result.reserve(by_x.size());
  for (const auto& [x, level] : by_x) {
    result.push_back(level);
  }
  return result;
}

std::vector<Level> pooled(std::span<const std::vector<Level>> participants) {
  std::vector<Level> all;
  for (const std::vector<Level>& levels : participants) {
    all.insert(all.end(), levels.begin(), levels.end());
  }
  return pooled(all);
}

}  // namespace haptolith

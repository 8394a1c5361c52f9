#include "haptolith/psychometrics/levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr double kSameStimulus =
    1e-12;  // max. relative difference of stimuli that count as equal, for instance in different rows

void requireCounts(const Level& level) {
  requireInRange("x of a level", level.x, {-kMostStimulus, kMostStimulus});
  requireInRange("n of a level", level.n, {0, kMostAnswers});
  requireInRange("k of a level", level.k, {0, level.n});
  for (const double count : {level.k, level.n}) {
    if (count != std::floor(count)) {
      throw InvalidParameter("responses of a level", fmt::format("{}", count), "a whole number");
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
    if (!result.empty() && x - result.back().x <= kSameStimulus * std::abs(x)) {
      Level& same = result.back();
      same = {same.x, same.k + level.k, same.n + level.n};
    } else {
      result.push_back(level);
    }
  }
  for (const Level& level : result) {
    requireInRange(fmt::format("responses to the stimulus {:g}", level.x), level.n, {0, kMostAnswers});
  }
  return result;
}

std::vector<Level> pooledWithin(std::span<const Level> levels, double tolerance) {
  requireInRange("pool tolerance", tolerance, {.lowest = 0});
  std::vector<Level> rest;
  rest.reserve(levels.size());
  for (const Level& level : levels) {
    requireCounts(level);
    if (level.n > 0) {
      rest.push_back(level);
    }
  }
  std::vector<Level> blocks;
  while (!rest.empty()) {
    const double first = rest.front().x;
    const auto is_other = [&](const Level& level) { return std::abs(level.x - first) > tolerance; };
    const auto others = std::stable_partition(rest.begin(), rest.end(), is_other);
    Level block;
    for (auto level = others; level != rest.end(); ++level) {
      block = {block.x + level->x * level->n, block.k + level->k, block.n + level->n};
    }
    block.x /= block.n;
    blocks.push_back(block);
    rest.erase(others, rest.end());
  }
  return pooled(blocks);
}

std::vector<Level> pooled(std::span<const std::vector<Level>> participants) {
  std::vector<Level> all;
  for (const std::vector<Level>& levels : participants) {
    all.insert(all.end(), levels.begin(), levels.end());
  }
  return pooled(all);
}

}  // namespace haptolith

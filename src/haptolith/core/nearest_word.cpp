#include "haptolith/core/nearest_word.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace haptolith {

namespace {

constexpr std::size_t kShortestPrefix = 3;

/// Letters to insert, drop or replace to make `b` of `a` (Levenshtein), row by row.
std::size_t typingErrors(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, replaced});
    }
  }
  return row.back();
}

}  // namespace

std::string_view nearestWord(std::string_view word, std::span<const std::string_view> candidates) {
  if (word.size() < kShortestPrefix) {
    return {};  // P9 is as near to P1 as to P2
  }
  std::string_view nearest;
  std::size_t fewest = std::max<std::size_t>(1, (word.size() + 1) / 3) + 1;
  for (const std::string_view candidate : candidates) {
    const bool begun = candidate.starts_with(word);
    const std::size_t errors = begun ? 0 : typingErrors(word, candidate);
    if (errors < fewest) {
      fewest = errors;
      nearest = candidate;
    }
  }
  return nearest;
}

}  // namespace haptolith

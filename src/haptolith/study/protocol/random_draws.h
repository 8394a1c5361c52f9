#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace haptolith {

// Random numbers of a study, identical on every machine and after every crash. Each draw has a separate generator,
// seeded from the study's seed and the purpose of the draw.

/// Purpose of random numbers; each has a separate stream, so that draws are independent of each other.
enum class Purpose : std::uint64_t {
  kBlockOrder,
  kPractice,
  kMain,
  kCatch,
  kTrialSeed,
  kAdaptiveOrder,
  kProcedure,
  kGroups,
  kTrust
};

/// Finaliser of SplitMix64 (Steele, Lea and Flood 2014): each bit of the result depends on every bit of the number.
constexpr std::uint64_t mixed(std::uint64_t number) {
  number = (number ^ (number >> 30)) * 0xBF58476D1CE4E5B9;
  number = (number ^ (number >> 27)) * 0x94D049BB133111EB;
  return number ^ (number >> 31);
}

/// Combines several numbers into one seed; their order matters.
constexpr std::uint64_t seedOf(std::initializer_list<std::uint64_t> parts) {
  std::uint64_t seed = 0;
  for (const std::uint64_t part : parts) {
    seed = mixed(seed + 0x9E3779B97F4A7C15 + mixed(part));
  }
  return seed;
}

/// Draws uniformly from 0 ... count - 1; identical on every machine, unlike the standard library's distributions.
inline std::size_t drawn(std::mt19937_64& random, std::size_t count) {
  const std::uint64_t largest = std::numeric_limits<std::uint64_t>::max();
  const std::uint64_t unfair = largest - largest % count;  // numbers from here up would bias the result
  std::uint64_t number = random();
  while (number >= unfair) {
    number = random();
  }
  return number % count;
}

/// Shuffles the values (Fisher and Yates): every order is equally likely.
template <class Value>
void shuffle(std::vector<Value>& values, std::mt19937_64& random) {
  for (std::size_t left = values.size(); left > 1; --left) {
    std::swap(values[left - 1], values[drawn(random, left)]);
  }
}

}  // namespace haptolith

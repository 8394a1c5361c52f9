#pragma once

#include <random>

namespace haptolith {

// Several in one expression belong in braces, Vec3{...}, which are evaluated in their order: arguments are not.

/// A number between -1 and 1, evenly; the same on every machine, which the library's distributions are not.
inline double uniformSigned(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-52 - 1;
}

/// A number of mean 0 and deviation 1, nearly normal: twelve even ones together (Irwin and Hall). Identical on every
/// machine.
inline double nearlyNormal(std::mt19937_64& random) {
  double sum = 0;
  for (int i = 0; i < 12; ++i) {
    sum += uniformSigned(random) / 2;
  }
  return sum;
}

}  // namespace haptolith

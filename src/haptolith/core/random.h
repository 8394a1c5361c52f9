#pragma once

#include <random>

namespace haptolith {

/// A number between -1 and 1, evenly; the same on every machine, which the library's distributions are not.
inline double uniformSigned(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-52 - 1;
}

}  // namespace haptolith

#pragma once

#include <boost/math/tools/toms748_solve.hpp>

#include <cstdint>

#include "haptolith/core/error.h"

namespace haptolith {

/// Finds the root of an increasing function in a range; returns the nearer end if there is none. (Alefeld,
/// Potra and Shi, Algorithm 748, ACM Trans. Math. Softw. 21(3), 1995.)
template <class Function>
[[nodiscard]] double findRoot(const Range& range, Function f) {
  const double at_lowest = f(range.lowest);
  const double at_highest = f(range.highest);
  if (at_lowest >= 0 || at_highest <= 0) {
    return at_lowest >= 0 ? range.lowest : range.highest;
  }
  std::uintmax_t iterations = 100;
  const auto bracket = boost::math::tools::toms748_solve(f, range.lowest, range.highest, at_lowest, at_highest,
                                                         boost::math::tools::eps_tolerance<double>(30), iterations);
  return (bracket.first + bracket.second) / 2;
}

}  // namespace haptolith

#pragma once

#include <boost/math/tools/minima.hpp>

#include <limits>

namespace haptolith {

/// Returns the argument of the minimum of a function of one variable between two bounds: the best point of an even
/// grid, refined by Brent's method between its neighbours. Accurate to about 1e-8 of the range, the limit of any search
/// without derivatives. Not for the tick.
/// @param function  finite inside the bounds; it is never called on the bounds themselves.
template <class Function>
double minimumBetween(double lowest, double highest, const Function& function) {
  constexpr int kCells = 200;  // fine enough to find the right minimum of any smooth function of this folder
  const double cell = (highest - lowest) / kCells;
  double best = lowest + cell / 2;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kCells; ++i) {
    const double x = lowest + (i + 0.5) * cell;
    const double value = function(x);
    if (value < least) {
      best = x;
      least = value;
    }
  }
  // Beyond the outermost cells there is only half a cell up to the bound.
  const double from = best - cell > lowest ? best - cell : lowest;
  const double to = best + cell < highest ? best + cell : highest;
  return boost::math::tools::brent_find_minima(function, from, to, std::numeric_limits<double>::digits / 2).first;
}

}  // namespace haptolith

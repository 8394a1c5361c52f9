#include "haptolith/bed/grain_classes.h"

#include <limits>

namespace haptolith {

GrainClasses::GrainClasses(double radius_m, int count) : count_(count) {
  // With the largest spread, 0.3, the smallest of a class has 0.7 of its R and the largest of the next 0.65.
  constexpr double kBetween = 0.675;
  for (int c = 0; c < kMost; ++c) {
    finer_than_[static_cast<std::size_t>(c)] = c + 1 < count ? static_cast<float>(radius_m * (kBetween * scale(c) - 1))
                                                             : -std::numeric_limits<float>::infinity();
  }
}

}  // namespace haptolith

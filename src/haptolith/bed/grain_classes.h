#pragma once

#include <array>
#include <cstddef>

namespace haptolith {

/// Sizes of grain in one bed: each class has half the radius of the one before it, and the same soil scaled by size
/// (rescaled(): k ~ R, F_c ~ R^2, m ~ R^3), so that stress, density and friction are the same in all. Class 0 is the
/// coarsest. A particle's class follows from its radius, because the sizes of two classes never overlap: see
/// SoilParameters::size_spread.
class GrainClasses {
 public:
  static constexpr int kMost = 4;

  /// @param radius_m  R of class 0. @param count  1 to kMost.
  explicit GrainClasses(double radius_m = 1, int count = 1);

  [[nodiscard]] int count() const noexcept { return count_; }
  /// R of a class over that of class 0: 1, 1/2, 1/4, 1/8.
  [[nodiscard]] static constexpr float scale(int grain_class) noexcept {
    return 1 / static_cast<float>(1 << grain_class);
  }

  /// Particles whose radius exceeds the mean of class 0 by less than this are of class c + 1 or finer; at the end of
  /// the chain there is none. In m, negative.
  [[nodiscard]] float finerThan(int c) const noexcept { return finer_than_[static_cast<std::size_t>(c)]; }

  /// The class of a particle whose radius exceeds the mean of class 0 by `excess_m`.
  [[nodiscard]] int of(float excess_m) const noexcept {
    int c = 0;
    while (excess_m < finerThan(c)) {
      ++c;
    }
    return c;
  }

 private:
  int count_;
  std::array<float, kMost> finer_than_{};
};

}  // namespace haptolith

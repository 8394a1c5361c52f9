#pragma once

#include <functional>
#include <vector>

#include "haptolith/bed/bed.h"

namespace haptolith {

/// What a graded bed is filled with before its grains settle together.
///
/// The finest fill the box that Grading describes, each coarser class a shell of two of its diameters around it, and
/// grains of the soil's own radius everything else. Every class is settled by itself, in a box that repeats itself, and
/// cut out of that. Where coarser grains were cut away finer ones go on into the gaps that these have left.
class GradedFilling {
 public:
  /// @param coarse  the soil as it is without finer grains, at rest. @param settled  makes a bed of one size of grain.
  GradedFilling(const BedParameters& bed, const LyingSoil& coarse,
                const std::function<std::vector<Float4>(const BedParameters&)>& settled);

  /// This soil and all that finds room in it, in whole groups of one class, coarsest first, then what is held. At first
  /// nobody is there; when they have settled together, they have sunk, and there is room for more.
  /// @throws InvalidParameter when no soil is where fine grains are wanted.
  [[nodiscard]] LyingSoil filledUp(const std::vector<Float4>& free) const;

 private:
  /// A box of grains of class c and finer, scene frame; it is open upwards.
  struct Region {
    double low_x, high_x, low_y, high_y, floor;

    /// How far inside its sides and over its floor a grain's centre is, in m; negative outside.
    [[nodiscard]] double depthOf(const Float4& grain) const;
    [[nodiscard]] bool holds(const Float4& grain) const { return depthOf(grain) > 0; }
    [[nodiscard]] Region grown(double by_m) const {
      return {low_x - by_m, high_x + by_m, low_y - by_m, high_y + by_m, floor - by_m};
    }
  };

  [[nodiscard]] BedParameters tileFor(int grain_class) const;
  [[nodiscard]] std::vector<Float4> placed(std::vector<Float4> made, const BedParameters& tile, int grain_class) const;
  [[nodiscard]] const Region& regionOf(int grain_class) const {
    return regions_[static_cast<std::size_t>(grain_class - 1)];
  }
  [[nodiscard]] double radiusOf(int grain_class) const;
  [[nodiscard]] bool belongs(const Float4& grain, int grain_class, const std::vector<Float4>& left_out) const;

  BedParameters bed_;
  int classes_;
  double surface_m_;
  std::vector<Region> regions_;                  ///< of classes 1 and finer, the largest first
  std::vector<std::vector<Float4>> candidates_;  ///< of each class
  std::vector<Float4> held_;                     ///< behind the sides, coarse
};

}  // namespace haptolith

#pragma once

#include <functional>
#include <vector>

#include "haptolith/bed/bed.h"

namespace haptolith {

/// Initial filling of a graded bed before its particles settle together.
///
/// The finest fill the box that Grading describes, each coarser class a shell of two of its diameters around it, and
/// grains of the soil's own radius everything else. Every class is settled alone in a periodic box and
/// cut out of that. Where coarser particles were cut away, finer ones continue into the gaps.
class GradedFilling {
 public:
  /// @param coarse  the soil as it is without finer grains, at rest. @param settled  makes a bed of one size of grain.
  GradedFilling(const BedParameters& bed, const LyingSoil& coarse,
                const std::function<std::vector<Float4>(const BedParameters&)>& settled);

  /// This soil and all that finds room in it, in whole groups of one class, coarsest first, then what is held. At first
  /// it is empty; when the particles have settled together, they have sunk, and there is room for more.
  /// @throws InvalidParameter when no soil is where fine grains are wanted.
  [[nodiscard]] LyingSoil filledUp(const std::vector<Float4>& free) const;

 private:
  /// A box of grains of class c and finer, scene frame; it is open upwards.
  struct Region {
    double low_x, high_x, low_y, high_y, floor;

    /// Distance of a particle's centre from the region's sides and floor, in m; negative outside.
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
  std::vector<Region> regions_;                  ///< regions of classes 1 and finer, the largest first
  std::vector<std::vector<Float4>> candidates_;  ///< candidates of each class
  std::vector<Float4> held_;                     ///< behind the sides, coarse
};

}  // namespace haptolith

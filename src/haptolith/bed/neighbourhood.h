#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/cell_grid.h"
#include "haptolith/bed/contact_lists.h"
#include "haptolith/bed/grain_classes.h"

namespace haptolith {

/// Range of the neighbour lists. For class c all lengths are scaled by its size.
struct NeighbourReach {
  GrainClasses classes = GrainClasses();
  double reach_m = 0;   ///< largest distance of a listed pair of particles of class 0 and the mean size; larger ones
                        ///< reach further
  double beyond_m = 0;  ///< part of it between their surfaces
  double largest_excess_m = 0;  ///< by how much a radius of class 0 may exceed the mean
};

/// Maintains the neighbour (Verlet) lists particle by particle; there is no step in which all lists are rebuilt.
///
/// Each particle has a reference position, where its list was built (BedState::reference_position). A pair is listed,
/// from both sides, exactly when the reference positions are closer than the cutoff of a contact plus a skin (Verlet
/// 1967). As long as no particle is further from its reference position than half the skin, every contact is listed.
/// The list of a particle that has moved further is rebuilt: 0.5 us for each such particle, 2 us and more out of cache,
/// nothing for the others. Slips are stored with the entries and stay where they are.
class Neighbourhood {
 public:
  Neighbourhood(std::size_t particles, const NeighbourReach& reach, const GridBox& box);

  /// Fills empty lists of all particles at `reference_position`, nearest neighbours first. Returns false if they do not
  /// fit: the bed has collapsed onto itself. Not for the tick: 0.5 us per particle.
  [[nodiscard]] bool buildAll(const std::vector<Float4>& reference_position, ContactLists& lists) noexcept;

  /// Rebuilds the lists of some particles at their `position`. May be called in the tick. False as buildAll().
  [[nodiscard]] bool rebuild(std::span<const std::int32_t> particles, const std::vector<Float4>& position,
                             std::vector<Float4>& reference_position, ContactLists& lists) noexcept;

  /// The cells of all classes in a box, and the number of changes: equal counts mean equal
  /// contents.
  struct Place {
    std::array<CellGrid::Block, GrainClasses::kMost> cells;
    std::uint64_t changes = 0;
    bool operator==(const Place&) const = default;
  };
  [[nodiscard]] Place placeOf(const Float4& low, const Float4& high) const noexcept {
    Place place{.cells = {}, .changes = changes_};
    for (std::size_t i = 0; i < grids_.size(); ++i) {
      place.cells[i] = grids_[i].blockOf(low, high);
    }
    return place;
  }
  /// Calls `each(particle)` for all particles in the box that this is the place of, and maybe others.
  template <class Each>
  void forEachIn(const Place& place, Each each) const noexcept {
    for (std::size_t i = 0; i < grids_.size(); ++i) {
      grids_[i].forEachIn(place.cells[i], each);
    }
  }
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  /// Makes a particle's list, and its entries in those of others, right for its new place.
  [[nodiscard]] bool rebuildList(std::int32_t particle, const std::vector<Float4>& reference_position,
                                 ContactLists& lists) noexcept;
  /// Puts the nearest first, so that the ends of a group's lists are rows without contact. (It also makes the
  /// order independent of the cells', which no saved state has.)
  void sortByDistance(std::size_t i, const std::vector<Float4>& reference_position, ContactLists& lists) noexcept;
  /// Writes who is near a particle to near_, in any order, and returns how many.
  [[nodiscard]] std::uint32_t findNear(std::int32_t particle, const std::vector<Float4>& reference_position) noexcept;
  [[nodiscard]] CellGrid& gridOf(const Float4& particle) noexcept {
    return grids_[static_cast<std::size_t>(classes_.of(particle.w))];
  }

  GrainClasses classes_;
  float reach_m_, beyond_m_, radius_m_, largest_excess_m_;
  Periods periods_;
  std::vector<CellGrid> grids_;  ///< one for each class
  std::uint64_t changes_ = 0;    ///< number of changes of cells
  std::vector<std::int32_t> candidates_, near_;
};

}  // namespace haptolith

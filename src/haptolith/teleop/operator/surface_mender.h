#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <future>
#include <optional>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/core/process/async.h"
#include "haptolith/teleop/operator/site_map.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Which grains are to lie elsewhere so that soil has another surface: each is the highest of where there is most too
/// much, and comes to lie in the lowest hollow of where there is most too little. What there is of soil stays as much.
/// Differences count over squares four grains' radii wide and more, and beyond what the roughness of grains explains:
/// soil is no smoother than that. Not for the tick.
/// @param wanted_m  height over the floor in each cell of `grid`, row by row; NaN: unchanged.
/// @param most      moves.
[[nodiscard]] std::vector<GrainMove> movesTowards(SeenSoil soil, const BedParameters& bed, const HeightGrid& grid,
                                                  const std::vector<double>& wanted_m, std::size_t most);

/// Whether a model's surface can be repaired: only with particles of one size.
[[nodiscard]] inline bool canMend(const BedParameters& model) {
  return grainClasses(model) == 1;
}

/// Keeps the surface of an operator's soil like that which the robot's camera sees: wherever the tool has been away for
/// a second before the command that the robot had come to when it looked, and is away now. Grains are taken from where
/// there is too much and laid where there is too little, never near the tool, and only while that is in the air: so no
/// hand feels it. Not for the tick.
class SurfaceMender {
 public:
  /// @param model      grains of which canMend().
  /// @param surface_m  height over the floor that is the map's zero.
  /// @param work       where grains are chosen, which takes some hundredths of a second.
  SurfaceMender(const BedParameters& model, const ToolParameters& tool, double surface_m, Work work = Work::kAtOnce);

  /// Takes the model's soil after tick `index`, its tool, and the known site. Call it at a few
  /// Hz, with a growing index.
  void look(std::uint64_t index, SeenSoil seen, const Vec3& tool_m, const SiteMap& site);

  /// A grain that is to lie elsewhere; none: not now.
  /// @param in_air  whether the hand feels no soil; if it does, those that are still to come are forgotten.
  [[nodiscard]] std::optional<GrainMove> next(bool in_air);
  /// The last move of next() could not be requested: it is repeated.
  void refused(const GrainMove& move) { moves_.push_front(move); }

 private:
  /// Those that have been chosen, once all before them are made.
  void take();

  BedParameters model_;
  double clear_m_;
  double surface_m_;
  Work work_;
  HeightGrid grid_;
  std::vector<std::uint64_t> touched_at_;  ///< when the tool was last near each cell
  std::future<std::vector<GrainMove>> coming_;
  std::deque<GrainMove> moves_;
};

}  // namespace haptolith

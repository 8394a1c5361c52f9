#include "haptolith/teleop/operator/surface_mender.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "haptolith/tool/tool_shape.h"

namespace haptolith {

namespace {

constexpr std::uint64_t kSettleTicks = 1000;
constexpr double kClearRadii = 6;  ///< distance in particle radii between a tool and repaired soil
constexpr std::size_t kMostMovesAtOnce = 40;
constexpr double kBlockRadii = 4;    ///< least width of what is compared
constexpr double kWorthwhile = 2.5;  ///< difference between two blocks, in units of one particle's change
constexpr double kRoughness =
    0.6;  ///< roughness between the surfaces of two realisations, over squares of that width, in R
constexpr double kPacking = 0.6;  ///< volume fraction of particles in a pile
constexpr double kGap = 0.02;     ///< gap between a placed particle and its support, in R
constexpr int kPlaces = 7;        ///< places tried along each side of a block
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Columns from..to-1, rows from..to-1 of a grid.
struct Cells {
  std::size_t column, columns_end, row, rows_end;
};

double radiusOf(const SeenSoil& soil, const Float4& sphere) {
  return soil.radius_m + static_cast<double>(sphere.w);
}

/// Four per particle diameter, but limited to a camera's map, whatever grid was received.
std::size_t mendingRaysOf(const SeenSoil& soil, const HeightGrid& grid) {
  constexpr double kMost = 1 << 20;  // limit for all cells
  const double along = std::min(2 * grid.cell_m / soil.radius_m, std::sqrt(kMost / static_cast<double>(grid.cells())));
  return static_cast<std::size_t>(std::max(1.0, std::round(along)));
}

/// Soil whose particles are moved one by one, with its target surface.
class Mending {
 public:
  Mending(SeenSoil soil, const BedParameters& bed, const HeightGrid& grid, const std::vector<double>& wanted_m)
      : soil_(std::move(soil)),
        bed_(bed),
        grid_(grid),
        wanted_m_(wanted_m),
        heights_m_(surfaceHeights(soil_, grid_, mendingRaysOf(soil_, grid_))),
        side_(
            static_cast<std::size_t>(std::ceil(std::max(0.0, (kBlockRadii * soil_.radius_m / grid_.cell_m - 1) / 2)))),
        moved_(soil_.grains.size(), false),
        spent_(grid_.cells(), false) {
    const double width_m = static_cast<double>(2 * side_ + 1) * grid_.cell_m;
    one_grain_m_ = 4.0 / 3 * std::numbers::pi * std::pow(soil_.radius_m, 3) / (kPacking * width_m * width_m);
  }

  /// The next move, which it takes as made; none: nothing more is worth it.
  std::optional<GrainMove> next() {
    while (true) {
      std::optional<std::size_t> high, low;
      double most_m = 0, least_m = 0;
      for (std::size_t cell = 0; cell < grid_.cells(); ++cell) {
        const double excess_m = excessAround(cell);
        if (std::isnan(excess_m)) {
          continue;
        }
        if (!spent_[cell] && (!high || excess_m > most_m)) {
          high = cell;
          most_m = excess_m;
        }
        if (!low || excess_m < least_m) {
          low = cell;
          least_m = excess_m;
        }
      }
      if (!high || !low || most_m - least_m < kWorthwhile * one_grain_m_ ||
          std::min(most_m, -least_m) < kRoughness * soil_.radius_m) {
        return std::nullopt;
      }
      const std::optional<std::size_t> grain = highestIn(*high);
      const std::optional<Vec3> place = grain ? lowestIn(*low, *grain) : std::nullopt;
      if (!place) {
        spent_[*high] = true;
        continue;
      }
      const Float4 from = soil_.grains[*grain];
      soil_.grains[*grain] = {static_cast<float>(place->x()), static_cast<float>(place->y()),
                              static_cast<float>(place->z()), from.w};
      moved_[*grain] = true;
      seeAgainAround(from);
      seeAgainAround(soil_.grains[*grain]);
      return GrainMove{*grain, Vec3(from.x, from.y, from.z), *place};
    }
  }

 private:
  [[nodiscard]] Cells blockAround(std::size_t cell) const {
    const std::size_t column = cell % grid_.columns, row = cell / grid_.columns;
    return {column - std::min(column, side_), std::min(grid_.columns, column + side_ + 1), row - std::min(row, side_),
            std::min(grid_.rows, row + side_ + 1)};
  }
  template <class Each>
  void forEach(const Cells& cells, Each each) const {
    for (std::size_t row = cells.row; row < cells.rows_end; ++row) {
      for (std::size_t column = cells.column; column < cells.columns_end; ++column) {
        each(row * grid_.columns + column);
      }
    }
  }
  /// Mean height around a cell over what is wanted; NaN where half of it, or the cell itself, is to stay.
  [[nodiscard]] double excessAround(std::size_t cell) const {
    if (std::isnan(wanted_m_[cell])) {
      return kNone;
    }
    double sum_m = 0, count = 0, all = 0;
    forEach(blockAround(cell), [&](std::size_t at) {
      ++all;
      if (!std::isnan(wanted_m_[at])) {
        sum_m += heights_m_[at] - wanted_m_[at];
        ++count;
      }
    });
    return 2 * count < all ? kNone : sum_m / count;
  }
  /// Whether the soil at a place may be changed.
  [[nodiscard]] bool mayChange(double x_m, double y_m) const {
    const double column = std::floor((x_m - grid_.x_m) / grid_.cell_m),
                 row = std::floor((y_m - grid_.y_m) / grid_.cell_m);
    return column >= 0 && row >= 0 && column < static_cast<double>(grid_.columns) &&
           row < static_cast<double>(grid_.rows) &&
           !std::isnan(wanted_m_[static_cast<std::size_t>(row) * grid_.columns + static_cast<std::size_t>(column)]);
  }
  [[nodiscard]] std::optional<std::size_t> highestIn(std::size_t cell) const {
    const Cells block = blockAround(cell);
    const double left_m = grid_.x_m + static_cast<double>(block.column) * grid_.cell_m;
    const double right_m = grid_.x_m + static_cast<double>(block.columns_end) * grid_.cell_m;
    const double front_m = grid_.y_m + static_cast<double>(block.row) * grid_.cell_m;
    const double back_m = grid_.y_m + static_cast<double>(block.rows_end) * grid_.cell_m;
    std::optional<std::size_t> highest;
    double top_m = 0;
    for (std::size_t i = 0; i < soil_.grains.size(); ++i) {
      const Float4& grain = soil_.grains[i];
      const double x_m = grain.x, y_m = grain.y, tip_m = static_cast<double>(grain.z) + radiusOf(soil_, grain);
      if (!moved_[i] && x_m >= left_m && x_m < right_m && y_m >= front_m && y_m < back_m && mayChange(x_m, y_m) &&
          (!highest || tip_m > top_m)) {
        highest = i;
        top_m = tip_m;
      }
    }
    return highest;
  }
  /// Lowest resting place of a particle that is lowered near a cell.
  [[nodiscard]] std::optional<Vec3> lowestIn(std::size_t cell, std::size_t grain) const {
    const Cells block = blockAround(cell);
    const double own_m = radiusOf(soil_, soil_.grains[grain]);
    const double width_m = static_cast<double>(block.columns_end - block.column) * grid_.cell_m;
    const double length_m = static_cast<double>(block.rows_end - block.row) * grid_.cell_m;
    const double left_m = grid_.x_m + static_cast<double>(block.column) * grid_.cell_m;
    const double front_m = grid_.y_m + static_cast<double>(block.row) * grid_.cell_m;
    std::vector<Float4> near;  // centre, and how close to it the grain may come
    const auto add_near = [&](const Float4& sphere) {
      const double touch_m = own_m + radiusOf(soil_, sphere);
      const double x_m = sphere.x, y_m = sphere.y;
      if (x_m > left_m - touch_m && x_m < left_m + width_m + touch_m && y_m > front_m - touch_m &&
          y_m < front_m + length_m + touch_m) {
        near.push_back({sphere.x, sphere.y, sphere.z, static_cast<float>(touch_m)});
      }
    };
    for (std::size_t i = 0; i < soil_.grains.size(); ++i) {
      if (i != grain) {
        add_near(soil_.grains[i]);
      }
    }
    std::ranges::for_each(soil_.stones, add_near);
    std::optional<Vec3> lowest;
    for (int i = 0; i < kPlaces * kPlaces; ++i) {
      const int column = i % kPlaces, row = i / kPlaces;
      const double x_m = left_m + (column + 0.5) / kPlaces * width_m;
      const double y_m = front_m + (row + 0.5) / kPlaces * length_m;
      if (!mayChange(x_m, y_m) || std::abs(x_m) > bed_.width_m / 2 - own_m ||
          std::abs(y_m) > bed_.length_m / 2 - own_m) {
        continue;
      }
      double z_m = own_m;
      for (const Float4& sphere : near) {
        const double aside_m = std::hypot(x_m - static_cast<double>(sphere.x), y_m - static_cast<double>(sphere.y));
        const double touch_m = sphere.w;
        if (aside_m < touch_m) {
          z_m = std::max(z_m, static_cast<double>(sphere.z) + std::sqrt(touch_m * touch_m - aside_m * aside_m));
        }
      }
      if (!lowest || z_m < lowest->z()) {
        lowest = Vec3(x_m, y_m, z_m);
      }
    }
    if (lowest) {
      lowest->z() += kGap * soil_.radius_m;
    }
    return lowest;
  }
  void seeAgainAround(const Float4& sphere) {
    const double reach_m = radiusOf(soil_, sphere);
    const auto span = [&](double middle_m, double origin_m, std::size_t cells) {
      const auto cell = [&](double at_m) {
        return static_cast<std::size_t>(
            std::clamp(std::floor((at_m - origin_m) / grid_.cell_m), 0.0, static_cast<double>(cells - 1)));
      };
      return std::pair(cell(middle_m - reach_m), cell(middle_m + reach_m) + 1);
    };
    const auto [column, columns_end] = span(static_cast<double>(sphere.x), grid_.x_m, grid_.columns);
    const auto [row, rows_end] = span(static_cast<double>(sphere.y), grid_.y_m, grid_.rows);
    const HeightGrid part{grid_.x_m + static_cast<double>(column) * grid_.cell_m,
                          grid_.y_m + static_cast<double>(row) * grid_.cell_m, grid_.cell_m, columns_end - column,
                          rows_end - row};
    const std::vector<double> heights_m = surfaceHeights(soil_, part, mendingRaysOf(soil_, grid_));
    for (std::size_t i = 0; i < heights_m.size(); ++i) {
      heights_m_[(row + i / part.columns) * grid_.columns + column + i % part.columns] = heights_m[i];
    }
  }

  SeenSoil soil_;
  const BedParameters& bed_;
  HeightGrid grid_;
  const std::vector<double>& wanted_m_;
  std::vector<double> heights_m_;
  std::size_t side_;        ///< cells of a block on each side of its middle one
  double one_grain_m_ = 0;  ///< by which a grain changes the mean height of a block
  std::vector<bool> moved_;
  std::vector<bool> spent_;  ///< whether nothing can be taken from around a cell
};

Eigen::Vector2d middleOf(const HeightGrid& grid, std::size_t cell) {
  const std::size_t column = cell % grid.columns, row = cell / grid.columns;
  return {grid.x_m + (static_cast<double>(column) + 0.5) * grid.cell_m,
          grid.y_m + (static_cast<double>(row) + 0.5) * grid.cell_m};
}

/// The known surface of a site, in cells at least as wide as a particle's radius.
struct KnownSite {
  HeightGrid grid;
  std::vector<double> heights_m;        ///< NaN: not all of it is known
  std::vector<std::uint64_t> commands;  ///< the earliest
};
KnownSite inCellsOfGrains(const SiteMap& site, double radius_m) {
  const HeightGrid& fine = site.grid();
  const auto together = static_cast<std::size_t>(std::max(1.0, std::ceil(radius_m / fine.cell_m)));
  KnownSite known{.grid = {fine.x_m, fine.y_m, static_cast<double>(together) * fine.cell_m, fine.columns / together,
                           fine.rows / together},
                  .heights_m = {},
                  .commands = {}};
  for (std::size_t cell = 0; cell < known.grid.cells(); ++cell) {
    double sum_m = 0;
    std::uint64_t command = std::numeric_limits<std::uint64_t>::max();
    for (std::size_t i = 0; i < together * together; ++i) {
      const std::size_t column = cell % known.grid.columns * together + i % together;
      const std::size_t at = (cell / known.grid.columns * together + i / together) * fine.columns + column;
      sum_m += site.heights()[at];
      command = std::min(command, site.commands()[at]);
    }
    known.heights_m.push_back(sum_m / static_cast<double>(together * together));
    known.commands.push_back(command);
  }
  return known;
}

}  // namespace

std::vector<GrainMove> movesTowards(SeenSoil soil, const BedParameters& bed, const HeightGrid& grid,
                                    const std::vector<double>& wanted_m, std::size_t most) {
  Mending mending(std::move(soil), bed, grid, wanted_m);
  std::vector<GrainMove> moves;
  while (moves.size() < most) {
    const std::optional<GrainMove> move = mending.next();
    if (!move) {
      break;
    }
    moves.push_back(*move);
  }
  return moves;
}

SurfaceMender::SurfaceMender(const BedParameters& model, const ToolParameters& tool, double surface_m, Work work)
    : model_(model),
      clear_m_(enclosingRadius(tool) + kClearRadii * model.soil.radius_m),
      surface_m_(surface_m),
      work_(work) {}

void SurfaceMender::look(std::uint64_t index, SeenSoil seen, const Vec3& tool_m, const SiteMap& site) {
  take();
  if (site.empty()) {
    return;
  }
  const KnownSite known = inCellsOfGrains(site, seen.radius_m);
  if (known.grid != grid_) {
    grid_ = known.grid;
    touched_at_.assign(grid_.cells(), index);
    moves_.clear();
  }
  std::vector<double> wanted_m(grid_.cells(), kNone);
  bool any = false;
  for (std::size_t cell = 0; cell < grid_.cells(); ++cell) {
    const Eigen::Vector2d place_m = middleOf(grid_, cell);
    const bool clear = (place_m - tool_m.head<2>()).norm() > clear_m_;
    touched_at_[cell] = clear ? touched_at_[cell] : index;
    const bool inside = std::abs(place_m.x()) < model_.width_m / 2 - 2 * model_.soil.radius_m &&
                        std::abs(place_m.y()) < model_.length_m / 2 - 2 * model_.soil.radius_m;
    if (inside && clear && known.commands[cell] >= touched_at_[cell] + kSettleTicks &&
        !std::isnan(known.heights_m[cell])) {
      wanted_m[cell] = std::max(0.0, known.heights_m[cell] + surface_m_);
      any = true;
    }
  }
  if (any && moves_.empty() && !coming_.valid()) {
    coming_ = setOut(work_, [seen = std::move(seen), model = model_, grid = grid_, wanted_m = std::move(wanted_m)] {
      return movesTowards(seen, model, grid, wanted_m, kMostMovesAtOnce);
    });
  }
}

void SurfaceMender::take() {
  if (moves_.empty() && isThere(coming_)) {
    std::ranges::copy(coming_.get(), std::back_inserter(moves_));
  }
}

std::optional<GrainMove> SurfaceMender::next(bool in_air) {
  take();
  if (!in_air) {  // moves chosen before further digging are obsolete
    moves_.clear();
  }
  if (moves_.empty()) {
    return std::nullopt;
  }
  const GrainMove move = moves_.front();
  moves_.pop_front();
  return move;
}

}  // namespace haptolith

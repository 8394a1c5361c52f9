#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "haptolith/core/math/portable_math.h"
#include "haptolith/core/process/in_parallel.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/mesh/distance_field.h"
#include "haptolith/mesh/outer_surface.h"
#include "haptolith/mesh/triangle_tree.h"

namespace haptolith {

namespace {

/// Work that no real tool needs: triangles that pass layers of the grid, and rows of a layer.
constexpr std::size_t kMostLayerTriangles = 200'000'000;
constexpr std::size_t kMostLayerHits = 20'000'000;
/// A spacing that does not fit is multiplied by this factor until it fits.
constexpr double kWider = 1.189207115002721;  // 2^(1/4)
constexpr int kMostWider = 32;
/// Walls must be this many spacings thick: then at least one point of every line across lies inside.
constexpr double kSpacingsPerWall = 2;

}  // namespace

/// Makes a field: its grid, the blocks near the surface, distances, signs.
class FieldMaker {
 public:
  FieldMaker(const MendedMesh& mended, const TriangleTree& surface, const DistanceFieldOptions& options)
      : mended_(mended), surface_(surface), options_(options), half_m_(mended.sheet_thickness_m / 2) {
    field_.band_m_ = options.band_m;
    field_.corners_ = cornersOf(mended.mesh);
    field_.corners_.low_m.array() -= half_m_;
    field_.corners_.high_m.array() += half_m_;
    for (const Vec3& point_m : mended.mesh.points_m) {
      field_.enclosing_radius_m_ = std::max(field_.enclosing_radius_m_, point_m.norm() + half_m_);
    }
  }

  /// Chooses the blocks that are to be kept at this spacing. @return false when they would not fit.
  [[nodiscard]] bool plan(double spacing_m) {
    field_.spacing_m_ = spacing_m;
    const double edge_m = kCells * spacing_m;
    const Vec3 size_m = field_.corners_.high_m - field_.corners_.low_m;
    double table = 1;
    Vec3 grid_m;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto e = static_cast<Eigen::Index>(axis);
      // A cell more on each side, so that what is beyond the grid is beyond the band.
      const double blocks = std::ceil((size_m[e] + 2 * (options_.band_m + spacing_m)) / edge_m);
      table *= blocks;
      grid_m[e] = blocks * edge_m;
      field_.blocks_[axis] = static_cast<int>(blocks);
    }
    field_.low_m_ = (field_.corners_.low_m + field_.corners_.high_m - grid_m) / 2;
    const double left = static_cast<double>(options_.most_bytes) - table * sizeof(std::int32_t);
    if (left < 0) {
      return false;
    }
    most_blocks_ = static_cast<std::size_t>(left / (sizeof(float) * DistanceField::kBlockValues));
    const std::array<int, 3>& blocks = field_.blocks_;
    std::vector<std::vector<std::int32_t>> found(static_cast<std::size_t>(blocks[2]));
    std::atomic<std::size_t> count = 0;
    inParallel(found.size(), options_.threads, [&](std::size_t z) {
      const int layer = static_cast<int>(z);
      collect({0, 0, layer}, {blocks[0], blocks[1], layer + 1}, -1, found[z], count);
    });
    throwIfStopped();
    blocks_.clear();
    if (count > most_blocks_) {
      return false;
    }
    for (std::vector<std::int32_t>& layer : found) {
      std::ranges::sort(layer);
      blocks_.insert(blocks_.end(), layer.begin(), layer.end());
    }
    return true;
  }

  /// Measures, for the spacing of the last plan().
  DistanceField make() {
    field_.table_.assign(tableSize(), DistanceField::kOutside);
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      field_.table_[static_cast<std::size_t>(blocks_[i])] = static_cast<std::int32_t>(i);
    }
    field_.values_.resize(blocks_.size() * DistanceField::kBlockValues);
    const auto for_all_blocks = [&](const auto& work) {
      inParallel(blocks_.size(), options_.threads, [&](std::size_t i) {
        throwIfStopped();
        work(i);
      });
    };
    for_all_blocks([&](std::size_t i) { measureOwn(i); });
    for_all_blocks([&](std::size_t i) { measureFarFaces(i); });
    if (mended_.sheet_thickness_m == 0) {
      makeSigns();
    }
    return std::move(field_);
  }

 private:
  static constexpr int kCells = DistanceField::kCells;
  static constexpr int kPoints = DistanceField::kPoints;

  [[nodiscard]] std::size_t tableSize() const {
    const auto [nx, ny, nz] = field_.blocks_;
    return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz);
  }
  [[nodiscard]] std::int32_t tablePlace(int x, int y, int z) const {
    return (z * field_.blocks_[1] + y) * field_.blocks_[0] + x;
  }
  [[nodiscard]] double reach() const { return options_.band_m + half_m_; }

  /// Blocks of a range that may hold a point within the band.
  void collect(std::array<int, 3> low, std::array<int, 3> high, std::int32_t hint, std::vector<std::int32_t>& found,
               std::atomic<std::size_t>& count) const {
    const double edge_m = kCells * field_.spacing_m_;
    Vec3 size;
    Vec3 middle;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      size[static_cast<Eigen::Index>(axis)] = high[axis] - low[axis];
      middle[static_cast<Eigen::Index>(axis)] = 0.5 * (high[axis] + low[axis]);
    }
    const double half_diagonal_m = 0.5 * edge_m * size.norm();
    const TriangleTree::Nearest nearest =
        surface_.nearest(field_.low_m_ + edge_m * middle, reach() + half_diagonal_m, hint);
    if (nearest.place < 0 || count > most_blocks_) {
      return;
    }
    Eigen::Index axis = 0;
    if (size.maxCoeff(&axis) == 1) {
      found.push_back(tablePlace(low[0], low[1], low[2]));
      ++count;
      return;
    }
    std::array<int, 3> end = high;
    std::array<int, 3> start = low;
    const auto longest = static_cast<std::size_t>(axis);
    end[longest] = start[longest] = (low[longest] + high[longest]) / 2;
    collect(low, end, nearest.place, found, count);
    collect(start, high, nearest.place, found, count);
  }

  /// First value of a block.
  [[nodiscard]] float* valuesOf(std::size_t block) {
    return field_.values_.data() + block * DistanceField::kBlockValues;
  }
  static std::size_t valuePlace(int x, int y, int z) {
    const int place = (z * kPoints + y) * kPoints + x;
    return static_cast<std::size_t>(place);
  }
  [[nodiscard]] std::array<int, 3> cellOf(std::size_t block) const {
    const auto [nx, ny, nz] = field_.blocks_;
    const std::int32_t place = blocks_[block];
    return {place % nx * kCells, place / nx % ny * kCells, place / nx / ny * kCells};
  }

  /// Beyond, no cell has a part of the band.
  [[nodiscard]] double farthest() const { return reach() + 4 * field_.spacing_m_; }
  [[nodiscard]] Vec3 pointAt(const Vec3& place) const { return field_.low_m_ + field_.spacing_m_ * place; }
  [[nodiscard]] float distanceOf(double squared_m2) const {
    return static_cast<float>(std::sqrt(squared_m2) - half_m_);
  }

  /// Distance without a sign of a grid point. @param hint  the nearest triangle of an adjacent point, then of this.
  [[nodiscard]] float measure(int x, int y, int z, std::int32_t& hint) const {
    const TriangleTree::Nearest nearest = surface_.nearest(pointAt(Vec3(x, y, z)), farthest(), hint);
    hint = nearest.place;
    return distanceOf(nearest.squared_m2);
  }

  /// The points that no other block has as its own, where few triangles may be the nearest to one of them: these are
  /// found once, by how far they are from the block's middle. False, and nothing done, where there are many.
  bool measureOwnByFew(std::size_t block, std::vector<TriangleTree::Near>& near) {
    constexpr std::size_t kFew = 200;
    const auto [x0, y0, z0] = cellOf(block);
    const double middle = 0.5 * (kCells - 1);
    const Vec3 middle_m = pointAt(Vec3(x0 + middle, y0 + middle, z0 + middle));
    const double half_diagonal_m = std::sqrt(3) * middle * field_.spacing_m_ * (1 + 1e-9);
    const double most_m = farthest() + half_diagonal_m;
    const TriangleTree::Nearest nearest = surface_.nearest(middle_m, most_m);
    const double nearest_m = nearest.place >= 0 ? std::sqrt(nearest.squared_m2) : 0;
    if (nearest.place >= 0 &&
        !surface_.within(middle_m, std::min(most_m, nearest_m + 2 * half_diagonal_m), kFew, near)) {
      return false;
    }
    float* values = valuesOf(block);
    for (int z = 0; z < kCells; ++z) {
      for (int y = 0; y < kCells; ++y) {
        for (int x = 0; x < kCells; ++x) {
          const Vec3 point_m = pointAt(Vec3(x0 + x, y0 + y, z0 + z));
          const double away_m = (point_m - middle_m).norm() * (1 + 1e-9);
          values[valuePlace(x, y, z)] = distanceOf(surface_.squaredDistanceTo(point_m, farthest(), near, away_m));
        }
      }
    }
    return true;
  }

  /// The points that no other block has as its own.
  void measureOwn(std::size_t block) {
    thread_local std::vector<TriangleTree::Near> near;
    near.clear();
    if (measureOwnByFew(block, near)) {
      return;
    }
    const auto [x0, y0, z0] = cellOf(block);
    float* values = valuesOf(block);
    std::int32_t hint = -1;
    for (int z = 0; z < kCells; ++z) {
      for (int row = 0; row < kCells; ++row) {
        const int y = z % 2 == 0 ? row : kCells - 1 - row;  // back and forth: consecutive points are adjacent
        for (int column = 0; column < kCells; ++column) {
          const int x = row % 2 == 0 ? column : kCells - 1 - column;
          values[valuePlace(x, y, z)] = measure(x0 + x, y0 + y, z0 + z, hint);
        }
      }
    }
  }

  /// The points of the far faces: the next blocks' own, where these are kept.
  void measureFarFaces(std::size_t block) {
    const std::array<int, 3> cell = cellOf(block);
    const auto [nx, ny, nz] = field_.blocks_;
    float* values = valuesOf(block);
    std::int32_t hint = -1;
    for (int z = 0; z < kPoints; ++z) {
      for (int y = 0; y < kPoints; ++y) {
        for (int x = y == kCells || z == kCells ? 0 : kCells; x < kPoints; ++x) {
          const int bx = cell[0] / kCells + x / kCells;
          const int by = cell[1] / kCells + y / kCells;
          const int bz = cell[2] / kCells + z / kCells;
          const std::int32_t next =
              bx < nx && by < ny && bz < nz ? field_.table_[static_cast<std::size_t>(tablePlace(bx, by, bz))] : -1;
          values[valuePlace(x, y, z)] =
              next >= 0 ? valuesOf(static_cast<std::size_t>(next))[valuePlace(x % kCells, y % kCells, z % kCells)]
                        : measure(cell[0] + x, cell[1] + y, cell[2] + z, hint);
        }
      }
    }
  }

  // Inside or outside, for all points of the grid. A layer of constant z cuts the triangles in lines, which are closed
  // rings of a closed surface; a row of constant y crosses these where the winding number changes by one. Whether an
  // edge is cut, and where, is found from its ends in one order, so that both of its triangles find the same and every
  // row ends with as many ways out as in: no ray can slip through between two triangles.
  void makeSigns() {
    is_inside_.assign(tableSize(), 0);
    const auto layers = static_cast<std::size_t>(field_.blocks_[2]) * kCells + 1;
    const TriangleMesh& mesh = mended_.mesh;
    std::vector<std::array<std::int32_t, 2>> passes(mesh.triangles.size());  // first and last layer
    std::vector<std::size_t> begin(layers + 1);
    std::size_t total = 0;
    for (std::size_t i = 0; i < passes.size(); ++i) {
      const auto [a, b, c] = cornersOf(mesh, mesh.triangles[i]);
      const auto layer_of = [&](double z) { return (z - field_.low_m_.z()) / field_.spacing_m_; };
      // The edges exclude a surplus one on each side.
      passes[i] = {std::max(0, static_cast<std::int32_t>(layer_of(std::min({a.z(), b.z(), c.z()})))),
                   std::min(static_cast<std::int32_t>(layers) - 1,
                            static_cast<std::int32_t>(layer_of(std::max({a.z(), b.z(), c.z()}))) + 1)};
      total += static_cast<std::size_t>(passes[i][1] - passes[i][0] + 1);
      if (total > kMostLayerTriangles) {
        throw InvalidParameter("mesh", "too many large triangles", "a surface that a tool can have");
      }
      for (std::int32_t layer = passes[i][0]; layer <= passes[i][1]; ++layer) {
        ++begin[static_cast<std::size_t>(layer) + 1];
      }
    }
    for (std::size_t layer = 0; layer < layers; ++layer) {
      begin[layer + 1] += begin[layer];
    }
    std::vector<std::int32_t> triangles(total);
    std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
    for (std::size_t i = 0; i < passes.size(); ++i) {
      for (std::int32_t layer = passes[i][0]; layer <= passes[i][1]; ++layer) {
        triangles[next[static_cast<std::size_t>(layer)]++] = static_cast<std::int32_t>(i);
      }
    }
    inParallel(layers, options_.threads, [&](std::size_t layer) {
      throwIfStopped();
      signLayer(static_cast<int>(layer), std::span(triangles).subspan(begin[layer], begin[layer + 1] - begin[layer]));
    });
    for (std::size_t place = 0; place < is_inside_.size(); ++place) {
      field_.table_[place] = is_inside_[place] != 0 ? DistanceField::kInside : field_.table_[place];
    }
  }

  struct RowHit {
    std::int32_t row;
    std::int32_t step;  ///< +1 goes in
    double x_m;
  };

  void signLayer(int layer, std::span<const std::int32_t> triangles) {
    const double z = field_.low_m_.z() + field_.spacing_m_ * layer;
    const double y0 = field_.low_m_.y();
    const int rows = field_.blocks_[1] * kCells + 1;
    std::vector<RowHit> hits;
    for (const std::int32_t triangle : triangles) {
      const auto corners = cornersOf(mended_.mesh, mended_.mesh.triangles[static_cast<std::size_t>(triangle)]);
      // Crossings of the triangle's rim with the layer, upwards and downwards.
      std::array<double, 2> up{};
      std::array<double, 2> down{};
      bool cut = false;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& from = corners[k];
        const Vec3& to = corners[(k + 1) % 3];
        if ((from.z() > z) != (to.z() > z)) {
          const bool rises = to.z() > z;
          const Vec3& low = rises ? from : to;
          const Vec3& high = rises ? to : from;
          const double part = (z - low.z()) / (high.z() - low.z());
          (rises ? up : down) = {low.x() + part * (high.x() - low.x()), low.y() + part * (high.y() - low.y())};
          cut = true;
        }
      }
      if (!cut) {
        continue;
      }
      const bool in = down[1] > up[1];
      const auto& [low_x, low_y] = in ? up : down;
      const auto& [high_x, high_y] = in ? down : up;
      const auto first = std::max(0, static_cast<std::int32_t>((low_y - y0) / field_.spacing_m_));
      const auto last = std::min(rows - 1, static_cast<std::int32_t>((high_y - y0) / field_.spacing_m_) + 1);
      for (std::int32_t row = first; row <= last; ++row) {
        const double y = y0 + field_.spacing_m_ * row;
        if ((low_y > y) != (high_y > y)) {
          hits.push_back({row, in ? 1 : -1, low_x + (y - low_y) / (high_y - low_y) * (high_x - low_x)});
        }
      }
      if (hits.size() > kMostLayerHits) {
        throw InvalidParameter("mesh", "too many large triangles", "a surface that a tool can have");
      }
    }
    std::ranges::sort(hits, [](const RowHit& a, const RowHit& b) {
      return std::tuple(a.row, a.x_m, a.step) < std::tuple(b.row, b.x_m, b.step);
    });
    for (std::size_t i = 0; i < hits.size();) {
      std::size_t end = i;
      while (end < hits.size() && hits[end].row == hits[i].row) {
        ++end;
      }
      signRow(hits[i].row, layer, std::span(hits).subspan(i, end - i));
      i = end;
    }
  }

  void signRow(int row, int layer, std::span<const RowHit> hits) {
    const auto [nx, ny, nz] = field_.blocks_;
    thread_local std::vector<std::uint8_t> inside;
    inside.resize(static_cast<std::size_t>(nx) * kCells + 1);
    std::size_t passed = 0;
    int winding = 0;
    for (std::size_t x = 0; x < inside.size(); ++x) {
      const double x_m = field_.low_m_.x() + field_.spacing_m_ * static_cast<double>(x);
      for (; passed < hits.size() && hits[passed].x_m < x_m; ++passed) {
        winding += hits[passed].step;
      }
      inside[x] = winding > 0 ? 1 : 0;
    }
    // A point on a face belongs to the blocks on both sides.
    for (int z = layer; z >= layer - (layer % kCells == 0 ? 1 : 0); --z) {
      for (int y = row; y >= row - (row % kCells == 0 ? 1 : 0); --y) {
        const int by = y < 0 ? -1 : y / kCells;
        const int bz = z < 0 ? -1 : z / kCells;
        if (by < 0 || bz < 0 || by >= ny || bz >= nz) {
          continue;
        }
        for (int bx = 0; bx < nx; ++bx) {
          const std::int32_t entry = field_.table_[static_cast<std::size_t>(tablePlace(bx, by, bz))];
          const std::size_t first = static_cast<std::size_t>(bx) * kCells;
          if (entry >= 0) {
            float* values =
                valuesOf(static_cast<std::size_t>(entry)) + valuePlace(0, row - by * kCells, layer - bz * kCells);
            for (std::size_t x = 0; x < kPoints; ++x) {
              values[x] = inside[first + x] != 0 ? -values[x] : values[x];
            }
          } else if (row == by * kCells && layer == bz * kCells && inside[first] != 0) {
            is_inside_[static_cast<std::size_t>(tablePlace(bx, by, bz))] =
                1;  // no surface is near: one corner decides for all
          }
        }
      }
    }
  }

  const MendedMesh& mended_;
  const TriangleTree& surface_;
  DistanceFieldOptions options_;
  double half_m_;  // half a sheet's thickness
  std::size_t most_blocks_ = 0;
  std::vector<std::int32_t> blocks_;     // places in the table, ascending
  std::vector<std::uint8_t> is_inside_;  // of blocks that are not kept
  DistanceField field_;
};

DistanceField makeDistanceField(const MendedMesh& mended, const DistanceFieldOptions& options) {
  requireInRange("spacing_m", options.spacing_m, kFieldSpacing_m);
  requireInRange("band_m", options.band_m, kFieldBand_m);
  requireInRange("threads", options.threads, {1, 1024});
  if (mended.mesh.triangles.empty() || mended.shells.size() != mended.mesh.triangles.size()) {
    throw InvalidParameter("mesh", "without triangles", "a repaired mesh");
  }
  const bool is_sheet = mended.sheet_thickness_m > 0;
  const TriangleTree tree(mended.mesh, options.threads);
  throwIfStopped();
  const double wall_m = is_sheet ? mended.sheet_thickness_m : thinnestWall(mended, tree, options.threads);
  const double widest_m = wall_m / kSpacingsPerWall;
  if (options.spacing_m > widest_m) {
    throw InvalidParameter("spacing_m", fmt::format("{:.3g}", options.spacing_m),
                           fmt::format("at most {:.3g}, for walls {:.3g} mm thick", widest_m, 1e3 * wall_m));
  }
  const bool overlaps = !is_sheet && mended.shell_count > 1;
  std::optional<TriangleMesh> outer;
  std::optional<TriangleTree> outer_tree;
  if (overlaps) {
    outer = outerSurface(mended, tree, options.spacing_m / 4, options.threads);
    throwIfStopped();
    if (outer->triangles.empty()) {
      throw InvalidParameter("mesh", "parts without volume", "a solid");
    }
    outer_tree.emplace(*outer, options.threads);
  }
  FieldMaker maker(mended, overlaps ? *outer_tree : tree, options);
  double spacing_m = options.spacing_m;
  if (!maker.plan(spacing_m)) {
    int too_fine = 0;
    int fits = kMostWider;
    while (fits - too_fine > 1) {
      const int middle = (fits + too_fine) / 2;
      (maker.plan(options.spacing_m * portable::pow(kWider, middle)) ? fits : too_fine) = middle;
    }
    spacing_m = options.spacing_m * portable::pow(kWider, fits);
    const double most_mib = static_cast<double>(options.most_bytes) / (1 << 20);
    if (!maker.plan(spacing_m) || spacing_m > widest_m) {
      throw InvalidParameter("spacing_m", fmt::format("{:.3g}", options.spacing_m),
                             fmt::format("at least {:.3g} to fit into {:.0f} MiB, and at most {:.3g} for walls {:.3g} "
                                         "mm thick; use a narrower band or a smaller tool",
                                         spacing_m, most_mib, widest_m, 1e3 * wall_m));
    }
  }
  DistanceField field = maker.make();
  if (spacing_m != options.spacing_m) {
    field.report_.push_back(
        fmt::format("Distances are stored every {:.3g} mm, because {:.3g} mm would need more than {:.0f} MiB.",
                    1e3 * spacing_m, 1e3 * options.spacing_m, static_cast<double>(options.most_bytes) / (1 << 20)));
  }
  return field;
}

}  // namespace haptolith

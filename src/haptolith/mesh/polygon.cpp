#include "haptolith/mesh/polygon.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace haptolith {

namespace {

using Point = Eigen::Vector2d;

/// Twice the area of a triangle, > 0 when it is passed counter-clockwise.
double turnOf(const Point& a, const Point& b, const Point& c) {
  return (b.x() - a.x()) * (c.y() - b.y()) - (b.y() - a.y()) * (c.x() - b.x());
}

/// Corners as they are seen along the mean normal: without its largest coordinate, counter-clockwise as a whole.
std::vector<Point> seenAlongNormal(std::span<const Vec3> corners) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3& next = corners[(i + 1) % corners.size()];
    normal += (corners[i] - corners[0]).cross(next - corners[0]);
  }
  Eigen::Index out = 0;
  normal.cwiseAbs().maxCoeff(&out);
  Eigen::Index x = (out + 1) % 3;
  Eigen::Index y = (out + 2) % 3;
  if (normal[out] < 0) {
    std::swap(x, y);
  }
  std::vector<Point> points;
  for (const Vec3& corner : corners) {
    points.emplace_back(corner[x] - corners[0][x], corner[y] - corners[0][y]);
  }
  return points;
}

/// The rest of a polygon while ears are cut off.
class EarClipper {
 public:
  explicit EarClipper(std::vector<Point> points) : points_(std::move(points)), left_(points_.size()) {
    for (std::size_t i = 0; i < left_.size(); ++i) {
      left_[i] = i;
    }
  }

  [[nodiscard]] bool hasDents() const {
    for (std::size_t i = 0; i < left_.size(); ++i) {
      if (bendAt(i) == Bend::kDent) {
        return true;
      }
    }
    return false;
  }

  /// False when `comparisons` did not suffice.
  [[nodiscard]] bool clip(std::vector<std::array<std::size_t, 3>>& triangles, std::int64_t& comparisons) {
    noteBlockers();
    std::size_t at = 0;
    std::size_t tried = 0;
    while (left_.size() > 3) {
      // A straight corner adds nothing; where a polygon crosses itself there may be no ear at all.
      const bool is_ear = tried < left_.size()       ? bendAt(at) == Bend::kCorner && isEmpty(at, comparisons)
                          : tried < 2 * left_.size() ? bendAt(at) == Bend::kStraight
                                                     : true;
      if (comparisons < 0) {
        return false;
      }
      if (!is_ear) {
        ++tried;
        --comparisons;
        at = (at + 1) % left_.size();
        continue;
      }
      triangles.push_back({left_[before(at)], left_[at], left_[after(at)]});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
      noteBlockers();
      comparisons -= static_cast<std::int64_t>(left_.size());
      at %= left_.size();
      tried = 0;
    }
    triangles.push_back({left_[0], left_[1], left_[2]});
    return true;
  }

 private:
  enum class Bend { kCorner, kStraight, kDent };

  [[nodiscard]] std::size_t before(std::size_t at) const { return (at + left_.size() - 1) % left_.size(); }
  [[nodiscard]] std::size_t after(std::size_t at) const { return (at + 1) % left_.size(); }

  /// Bend of the outline at a corner. A bend within the rounding of a file's numbers is straight.
  [[nodiscard]] Bend bendAt(std::size_t at) const {
    constexpr double kStraight_rad = 1e-6;
    const Point& a = points_[left_[before(at)]];
    const Point& b = points_[left_[at]];
    const Point& c = points_[left_[after(at)]];
    const double turn = turnOf(a, b, c);
    if (std::abs(turn) <= kStraight_rad * (b - a).norm() * (c - b).norm()) {
      return Bend::kStraight;
    }
    return turn > 0 ? Bend::kCorner : Bend::kDent;
  }

  /// Only reflex corners can be inside an ear.
  void noteBlockers() {
    blockers_.clear();
    for (std::size_t at = 0; at < left_.size(); ++at) {
      if (bendAt(at) != Bend::kCorner) {
        blockers_.push_back(left_[at]);
      }
    }
  }

  /// Whether no other corner is inside the triangle at this one, or on its edges.
  [[nodiscard]] bool isEmpty(std::size_t at, std::int64_t& comparisons) const {
    const std::array<std::size_t, 3> own{left_[before(at)], left_[at], left_[after(at)]};
    const Point& a = points_[own[0]];
    const Point& b = points_[own[1]];
    const Point& c = points_[own[2]];
    comparisons -= static_cast<std::int64_t>(blockers_.size());
    return std::ranges::none_of(blockers_, [&](std::size_t other) {
      const Point& p = points_[other];
      const bool same = p == a || p == b || p == c;
      return !same && turnOf(a, b, p) >= 0 && turnOf(b, c, p) >= 0 && turnOf(c, a, p) >= 0;
    });
  }

  std::vector<Point> points_;
  std::vector<std::size_t> left_;      ///< numbers of corners, in order
  std::vector<std::size_t> blockers_;  ///< dents, and straight ones
};

}  // namespace

bool PolygonCutter::cut(std::span<const Vec3> corners, std::vector<std::array<std::size_t, 3>>& triangles) {
  triangles.clear();
  if (corners.size() > 3) {
    EarClipper clipper(seenAlongNormal(corners));
    if (clipper.hasDents()) {
      return clipper.clip(triangles, left_);
    }
  }
  for (std::size_t i = 2; i < corners.size(); ++i) {
    triangles.push_back({0, i - 1, i});
  }
  return true;
}

}  // namespace haptolith

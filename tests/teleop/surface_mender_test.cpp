#include "haptolith/teleop/operator/surface_mender.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "haptolith/scene/scene.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/tool/tool_shape.h"

namespace haptolith {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
const HandState kAway{{{{0, 0, 1}, Quat::Identity()}, {}}};

SceneFile dig() {
  const std::vector<std::string> coarser{"soil.radius_mm=8"};
  return findSceneFile("teleop-model", coarser);
}

/// A bed without a tool in it, and heights of its soil in cells of 10 mm.
struct Site {
  Scene scene{dig().bed, dig().tool};
  HeightGrid grid = gridWithinSides(scene.bed().parameters(), 0.01);

  Site() { scene.placeTool(kAway); }
  [[nodiscard]] std::vector<double> heights() const { return surfaceHeights(seenSoil(scene.bed()), grid, 4); }
  [[nodiscard]] double x(std::size_t cell) const {
    return grid.x_m + (static_cast<double>(cell % grid.columns) + 0.5) * grid.cell_m;
  }
  [[nodiscard]] double y(std::size_t cell) const {
    return grid.y_m + (std::floor(static_cast<double>(cell / grid.columns)) + 0.5) * grid.cell_m;
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      ASSERT_EQ(scene.tick(kAway), StepStatus::kOk);
    }
  }
  /// RMS difference of its surface from a known one.
  [[nodiscard]] double apart(const std::vector<double>& wanted_m, const std::vector<bool>& where) const {
    const std::vector<double> now_m = heights();
    double sum = 0, count = 0;
    for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
      if (where[cell] && !std::isnan(wanted_m[cell])) {
        sum += std::pow(now_m[cell] - wanted_m[cell], 2);
        ++count;
      }
    }
    return std::sqrt(sum / count);
  }
};

/// Moves grains until nothing is worth it; returns how many were.
std::size_t mend(Site& site, const std::vector<double>& wanted_m) {
  std::size_t moved = 0;
  for (int look = 0; look < 12; ++look) {
    const std::vector<GrainMove> moves =
        movesTowards(seenSoil(site.scene.bed()), site.scene.bed().parameters(), site.grid, wanted_m, 40);
    if (moves.empty()) {
      return moved;
    }
    for (const GrainMove& move : moves) {
      moved += site.scene.moveGrain(move) ? 1 : 0;
      site.run(1);
    }
    site.run(200);
  }
  ADD_FAILURE() << "it goes on and on";
  return moved;
}

TEST(MovesTowards, DigATrenchAndHeapItUpAndLeaveTheRest) {
  Site site;
  const std::vector<double> before_m = site.heights();
  std::vector<double> wanted_m = before_m;
  std::vector<bool> shaped(wanted_m.size()), untouched(wanted_m.size());
  for (std::size_t cell = 0; cell < wanted_m.size(); ++cell) {
    const bool along = std::abs(site.y(cell)) < 0.07;
    const bool trench = along && site.x(cell) > -0.09 && site.x(cell) < -0.04;
    const bool heap = along && site.x(cell) > 0.04 && site.x(cell) < 0.09;
    wanted_m[cell] += trench ? -0.02 : heap ? 0.02 : 0;
    shaped[cell] = trench || heap;
    untouched[cell] = std::abs(site.x(cell)) < 0.01 || std::abs(site.y(cell)) > 0.11;
  }
  EXPECT_NEAR(site.apart(wanted_m, shaped), 0.02, 1e-6);
  const std::size_t moved = mend(site, wanted_m);
  // 2 * 0.05 * 0.14 * 0.02 / 2 m^3 of soil, of which grains of 8 mm fill 0.6
  EXPECT_NEAR(static_cast<double>(moved), 0.6 * 0.05 * 0.14 * 0.02 / (4.0 / 3 * 3.1416 * std::pow(8e-3, 3)), 20);
  EXPECT_LT(site.apart(wanted_m, shaped), 1.1 * 8e-3);
  EXPECT_LT(site.apart(before_m, untouched), 1e-3);
  EXPECT_LT(site.scene.bed().largestSpeed(), 0.05);
}

const Site& level() {
  static const Site kLevel;
  return kLevel;
}

TEST(MovesTowards, LeaveSoilWhoseSurfaceIsAsWantedOrIsNotKnownOrHasNowhereToGo) {
  const Site& site = level();
  const std::vector<double> before_m = site.heights();
  const auto moves = [&](const std::vector<double>& wanted_m) {
    return movesTowards(seenSoil(site.scene.bed()), site.scene.bed().parameters(), site.grid, wanted_m, 40).size();
  };
  EXPECT_EQ(moves(before_m), 0U);
  EXPECT_EQ(moves(std::vector<double>(before_m.size(), kNone)), 0U);
  std::vector<double> lower_m = before_m;
  std::ranges::for_each(lower_m, [](double& height) { height -= 0.02; });
  EXPECT_EQ(moves(lower_m), 0U) << "there is too much of it everywhere";
  std::vector<double> level_m(before_m.size(), dig().bed.depth_m);
  EXPECT_LT(moves(level_m), 5U) << "grains are no smoother";
}

/// A camera's map of a level site with a dug strip and a pile next to it.
SiteMap dugSite(const Site& site, std::uint64_t command) {
  SiteMap map;
  std::uint64_t number = 0;
  for (std::size_t row = 0; row < site.grid.rows; row += SitePacket::kSide) {
    for (std::size_t column = 0; column < site.grid.columns; column += SitePacket::kSide) {
      SitePacket packet{.robot_connection = 1, .grid = site.grid, .column = column, .row = row};
      packet.columns = std::min(SitePacket::kSide, site.grid.columns - column);
      packet.rows = std::min(SitePacket::kSide, site.grid.rows - row);
      packet.number = ++number;
      packet.index = command;
      for (std::size_t i = 0; i < packet.columns * packet.rows; ++i) {
        const double x_m = site.x(column + i % packet.columns);
        packet.steps.push_back(x_m < -0.06 ? -200 : x_m > 0.06 ? 200 : 0);
      }
      EXPECT_TRUE(map.take(packet));
    }
  }
  return map;
}

std::vector<GrainMove> movesOf(SurfaceMender& mender) {
  std::vector<GrainMove> moves;
  while (const std::optional<GrainMove> move = mender.next(true)) {
    moves.push_back(*move);
  }
  return moves;
}

TEST(SurfaceMender, MendsWhatTheRobotSawAfterTheToolHadGone) {
  const Site& site = level();
  const BedParameters& bed = site.scene.bed().parameters();
  const double surface_m = meanSurfaceHeight(site.scene.bed());
  const auto moves_after = [&](std::uint64_t command, const Vec3& tool_m) {
    SurfaceMender mender(bed, site.scene.tool(), surface_m);
    mender.look(0, seenSoil(site.scene.bed()), tool_m, dugSite(site, command));
    return movesOf(mender);
  };
  EXPECT_TRUE(moves_after(999, kAway.pose.position_m).empty()) << "it had not settled then, for all anybody knows";
  const std::vector<GrainMove> all = moves_after(1000, {1, 0, 0});
  EXPECT_GT(all.size(), 20U);
  for (const GrainMove& move : all) {
    EXPECT_GT(move.to_m.x(), 0.05);
    EXPECT_LT(move.from_m.x(), -0.05);
    EXPECT_EQ(move.from_m,
              Vec3(site.scene.bed().state().position[move.grain].x, site.scene.bed().state().position[move.grain].y,
                   site.scene.bed().state().position[move.grain].z));
  }
  const Vec3 tool_m(0.1, 0, surface_m);
  for (const GrainMove& move : moves_after(1000, tool_m)) {
    EXPECT_GT((move.to_m - tool_m).norm(), enclosingRadius(site.scene.tool()) + 4 * bed.soil.radius_m);
  }
  SurfaceMender mender(bed, site.scene.tool(), surface_m);
  const SiteMap map = dugSite(site, 1000);
  for (const double y_m : {-0.1, 0.0, 0.1}) {  // the tool was there, later than the robot saw it
    mender.look(500, seenSoil(site.scene.bed()), {0.08, y_m, surface_m}, map);
    mender.look(500, seenSoil(site.scene.bed()), {-0.08, y_m, surface_m}, map);
  }
  mender.look(1000, seenSoil(site.scene.bed()), {1, 0, 0}, map);
  EXPECT_TRUE(movesOf(mender).empty());
  mender.look(3000, seenSoil(site.scene.bed()), {1, 0, 0}, dugSite(site, 1500));
  EXPECT_EQ(movesOf(mender), all);
}

TEST(SurfaceMender, TellsAgainWhatWasRefused) {
  const Site& site = level();
  SurfaceMender mender(site.scene.bed().parameters(), site.scene.tool(), meanSurfaceHeight(site.scene.bed()));
  mender.look(0, seenSoil(site.scene.bed()), {1, 0, 0}, dugSite(site, 1000));
  const std::optional<GrainMove> first = mender.next(true);
  ASSERT_TRUE(first);
  mender.refused(*first);
  EXPECT_EQ(mender.next(true), first);
  EXPECT_NE(mender.next(true), first);
  EXPECT_FALSE(mender.next(false)) << "somebody would feel it";
  EXPECT_FALSE(mender.next(true)) << "and may have dug since";
  mender.look(250, seenSoil(site.scene.bed()), {1, 0, 0}, dugSite(site, 1250));
  EXPECT_TRUE(mender.next(true));
}

TEST(SurfaceMender, HoldsOutWhateverMapItIsGiven) {
  const Site& site = level();
  for (const HeightGrid& grid :
       {HeightGrid{-0.1, -0.1, 1e-4, 256, 256}, HeightGrid{-50, 50, 1, 64, 1024}, HeightGrid{-0.5, -0.5, 1, 1, 1},
        HeightGrid{-0.1, -0.1, 1e-4, 3, 3}, HeightGrid{90, 90, 0.01, 64, 64}}) {
    SiteMap map;
    std::uint64_t number = 0;
    for (std::size_t row = 0; row < grid.rows; row += SitePacket::kSide) {
      for (std::size_t column = 0; column < grid.columns; column += SitePacket::kSide) {
        SitePacket packet{.robot_connection = 1, .grid = grid, .column = column, .row = row};
        packet.columns = std::min(SitePacket::kSide, grid.columns - column);
        packet.rows = std::min(SitePacket::kSide, grid.rows - row);
        packet.number = ++number;
        packet.index = std::numeric_limits<std::uint64_t>::max();
        for (std::size_t i = 0; i < packet.columns * packet.rows; ++i) {
          packet.steps.push_back(static_cast<std::int16_t>(i * 7919 % 65536 - 32768));
        }
        ASSERT_TRUE(map.take(packet));
      }
    }
    SurfaceMender mender(site.scene.bed().parameters(), site.scene.tool(), meanSurfaceHeight(site.scene.bed()));
    mender.look(0, seenSoil(site.scene.bed()), {1, 0, 0}, map);
    for (const GrainMove& move : movesOf(mender)) {
      EXPECT_TRUE(move.to_m.allFinite());
      EXPECT_LT(std::abs(move.to_m.x()), site.scene.bed().parameters().width_m / 2);
    }
  }
}

TEST(SurfaceMender, IsForGrainsOfOneSize) {
  EXPECT_TRUE(canMend(dig().bed));
  EXPECT_FALSE(canMend(findSceneFile("fine-grains").bed));
}

}  // namespace
}  // namespace haptolith

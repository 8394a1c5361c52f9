#include "haptolith/tool/tool_box.h"

#include <algorithm>
#include <random>
#include <vector>

#include "haptolith/tool/tool_shape.h"

#include "../bed/every_target.h"

namespace haptolith {
namespace {

constexpr double kRadius_m = 0.007;

class ToolBoxOnEveryTarget : public EveryTarget {};

TEST_F(ToolBoxOnEveryTarget, LeavesOutNobodyWhoTouchesTheToolAndMostWhoDoNot) {
  forEachTarget([] {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> any(-1, 1);
    for (const ToolShape shape : kToolShapes) {
      if (shape == ToolShape::kJaws) {
        continue;  // whose contacts are two
      }
      ToolParameters tool;
      tool.shape = shape;
      tool.length_m = 0.08;
      int touching = 0;
      int near = 0;
      int all = 0;
      for (int pose = 0; pose < 200; ++pose) {
        const Pose scene_T_tool{Vec3(any(random), any(random), 0.1 * any(random)),
                                Quat(any(random), any(random), any(random), any(random)).normalized()};
        std::vector<Float4> group;
        while (group.size() < kGroup) {
          const Vec3 p = scene_T_tool.position_m + 0.09 * Vec3(any(random), any(random), any(random));
          group.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), 0});
        }
        const std::uint32_t bits =
            nearBox(boxAround(tool, scene_T_tool), static_cast<float>(kRadius_m + 2e-6), group.data());
        for (std::size_t i = 0; i < kGroup; ++i) {
          const Vec3 centre(group[i].x, group[i].y, group[i].z);
          const Vec3 in_tool = scene_T_tool.orientation.conjugate() * (centre - scene_T_tool.position_m);
          const bool touches = penetration(tool, in_tool, kRadius_m, 0).depth_m >= 0;
          const bool found = (bits >> i & 1) != 0;
          EXPECT_TRUE(found || !touches) << static_cast<int>(shape) << " " << in_tool.transpose();
          touching += touches ? 1 : 0;
          near += found ? 1 : 0;
          ++all;
        }
      }
      EXPECT_GT(touching, 5);
      EXPECT_LT(near, all / 2);
      if (shape == ToolShape::kBox) {
        EXPECT_EQ(near, touching) << "the box is the tool";
      }
    }
  });
}

TEST_F(ToolBoxOnEveryTarget, FindsNoGhosts) {
  forEachTarget([] {
    const std::vector<Float4> ghosts(kGroup, kGhost);
    EXPECT_EQ(nearBox(boxAround({}, Pose{}), 1, ghosts.data()), 0U);
  });
}

}  // namespace
}  // namespace haptolith

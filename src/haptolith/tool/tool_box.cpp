#include "haptolith/tool/tool_box.h"

#include "haptolith/tool/tool_shape.h"

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "haptolith/tool/tool_box.cpp"
#include <hwy/foreach_target.h>  // before highway.h
#include <hwy/highway.h>
#include "haptolith/bed/kernel/float4_vectors-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

std::uint32_t nearBoxOf(const ToolBox& box, float reach_m, const Float4* group) {
  const D d;
  std::uint32_t near = 0;
  for (std::size_t in_group = 0; in_group < kGroup; in_group += hn::Lanes(d)) {
    const Float4Vectors centre = loadFloat4(group + in_group);
    const V x = centre.x - hn::Set(d, box.origin_m[0]);
    const V y = centre.y - hn::Set(d, box.origin_m[1]);
    const V z = centre.z - hn::Set(d, box.origin_m[2]);
    V squared = hn::Zero(d);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& a = box.axes[axis];
      const V along = MulAdd(x, hn::Set(d, a[0]), MulAdd(y, hn::Set(d, a[1]), z * hn::Set(d, a[2])));
      const V outside =
          larger(hn::Abs(along - hn::Set(d, box.middle_m[axis])) - hn::Set(d, box.half_edges_m[axis]), hn::Zero(d));
      squared = MulAdd(outside, outside, squared);
    }
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, squared <= hn::Set(d, reach_m * reach_m), bits);
    near |= (bits[0] | std::uint32_t{bits[1]} << 8) << in_group;
  }
  return near;
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace haptolith {

HWY_EXPORT(nearBoxOf);

std::uint32_t nearBox(const ToolBox& box, float reach_m, const Float4* group) noexcept {
  return HWY_DYNAMIC_DISPATCH(nearBoxOf)(box, reach_m, group);
}

namespace {

std::array<float, 3> floats(const Vec3& v) noexcept {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

}  // namespace

ToolBox boxAround(const ToolParameters& tool, const Pose& scene_T_tool) noexcept {
  const ToolCorners corners = cornersOf(tool);
  const Eigen::Matrix3d rotation = scene_T_tool.orientation.toRotationMatrix();
  return {.origin_m = floats(scene_T_tool.position_m),
          .axes = {floats(rotation.col(0)), floats(rotation.col(1)), floats(rotation.col(2))},
          .middle_m = floats((corners.low_m + corners.high_m) / 2),
          .half_edges_m = floats((corners.high_m - corners.low_m) / 2)};
}

}  // namespace haptolith
#endif  // HWY_ONCE

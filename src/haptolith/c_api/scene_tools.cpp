// The tools of a scene, by their numbers.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <haptolith/haptolith.h>

#include <algorithm>
#include <string>
#include <vector>

#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/scene_object.h"
#include "haptolith/c_api/values.h"
#include "haptolith/c_api/with_handle.h"
#include "haptolith/core/error.h"

using namespace haptolith;
using namespace haptolith::library;

namespace {

/// Does `body` with the scene at 1 kHz, if it has such a tool. @param argument  that must not be NULL.
template <class Body>
std::int32_t withTool(const hapto_scene* scene, std::uint32_t tool, const void* argument, Body&& body) noexcept {
  return quicklyWith(scene, argument, [&](SceneObject& object) -> std::int32_t {
    return tool < object.scene().tools() ? body(object) : HAPTO_WRONG_TOOL;
  });
}

bool isShare(double share) noexcept {
  return share >= 0 && share <= 1;
}

std::int32_t driveOf(const Joint& joint) noexcept {
  switch (joint.drive) {
    case Drive::kNone: return HAPTO_DRIVE_NONE;
    case Drive::kSpeed: return HAPTO_DRIVE_SPEED;
    case Drive::kTorque: return HAPTO_DRIVE_TORQUE;
    case Drive::kFree: return HAPTO_DRIVE_FREE;
  }
  return HAPTO_DRIVE_NONE;
}

hapto_tool_state stateOf(const SceneObject& object, std::size_t tool) noexcept {
  const Scene& scene = object.scene();
  const JointState& joint = scene.joint(tool);
  hapto_tool_state state{.size = 0,
                         .in_soil = object.inSoil(tool) ? 1 : 0,
                         .drive = driveOf(scene.tool(tool).joint),
                         .reserved = 0,
                         .scene_T_tool = pose(scene.toolPose(tool)),
                         .scene_T_turned = pose(scene.turnedToolPose(tool)),
                         .soil_wrench = wrench(scene.soilWrench(tool)),
                         .angle_rad = joint.angle_rad,
                         .speed_rad_s = joint.speed_rad_s,
                         .soil_torque_nm = joint.soil_torque_nm,
                         .motor_torque_nm = joint.motor_torque_nm,
                         .opening_m = scene.opening(tool),
                         .grip_force_n = scene.soilForce(tool).grip_n,
                         .fade = object.fade(tool),
                         .stiffness_n_m = {},
                         .force_low_n = 0,
                         .force_high_n = 0};
  giveBand(scene.forceBand(tool), state);
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{state.stiffness_n_m} = scene.contactStiffness(tool);
  return state;
}

}  // namespace

std::int32_t hapto_scene_tools(const hapto_scene* scene, std::uint32_t* count) {
  return quicklyWith(scene, count, [&](const SceneObject& object) {
    *count = static_cast<std::uint32_t>(object.scene().tools());
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_tool_name(const hapto_scene* scene, std::uint32_t tool, const char** name) {
  return withTool(scene, tool, name, [&](const SceneObject& object) {
    *name = object.toolNames()[tool].c_str();
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_find_tool(const hapto_scene* scene, const char* name, std::uint32_t* tool) {
  if (name == nullptr || tool == nullptr) {
    return wrongArgument(HAPTO_NULL, name == nullptr ? "name" : "tool");
  }
  return withHandle(scene, "scene", [&](const SceneObject& object) {
    const std::vector<std::string>& names = object.toolNames();
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
      throw InvalidParameter("tool", fmt::format("'{}'", name), fmt::format("one of {}", fmt::join(names, ", ")));
    }
    *tool = static_cast<std::uint32_t>(found - names.begin());
  });
}

std::int32_t hapto_scene_step_tools(hapto_scene* scene, const hapto_pose* poses, const hapto_twist* twists,
                                    std::uint32_t count, hapto_wrench* soil_wrenches) {
  return quicklyWith(scene, poses,
                     [&](SceneObject& object) { return object.stepTools(poses, twists, count, soil_wrenches); });
}

std::int32_t hapto_scene_steps_tools(hapto_scene* scene, std::uint64_t ticks, const hapto_pose* poses,
                                     const hapto_twist* twists, std::uint32_t count, hapto_wrench* soil_wrenches,
                                     std::uint64_t* done) {
  if (done != nullptr) {
    *done = 0;
  }
  return quicklyWith(scene, poses, [&](SceneObject& object) {
    std::int32_t status = count == object.scene().tools() ? HAPTO_OK : HAPTO_WRONG_TOOL;
    for (std::uint64_t t = 0; t < ticks && status == HAPTO_OK; ++t) {
      const std::uint64_t first = t * count;
      status = object.stepTools(poses + first, twists == nullptr ? nullptr : twists + first, count,
                                soil_wrenches == nullptr ? nullptr : soil_wrenches + first);
      if (done != nullptr && status == HAPTO_OK) {
        ++*done;
      }
    }
    return status;
  });
}

std::int32_t hapto_scene_tool_place(hapto_scene* scene, std::uint32_t tool, const hapto_pose* scene_T_tool) {
  return withTool(scene, tool, scene_T_tool,
                  [&](SceneObject& object) { return object.placeTool(tool, *scene_T_tool); });
}

std::int32_t hapto_scene_tool_set_opening(hapto_scene* scene, std::uint32_t tool, double share) {
  return withTool(scene, tool, &share, [&](SceneObject& object) {
    if (!isShare(share)) {
      return HAPTO_INVALID_PARAMETER;
    }
    object.setOpening(tool, share);
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_tool_set_fade(hapto_scene* scene, std::uint32_t tool, double share) {
  return withTool(scene, tool, &share, [&](SceneObject& object) {
    if (!isShare(share)) {
      return HAPTO_INVALID_PARAMETER;
    }
    object.setFade(tool, share);
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_tool_set_drive(hapto_scene* scene, std::uint32_t tool, double value) {
  return withTool(scene, tool, &value, [&](SceneObject& object) { return object.setDrive(tool, value); });
}

std::int32_t hapto_scene_tool_get_state(const hapto_scene* scene, std::uint32_t tool, hapto_tool_state* out) {
  if (const std::int32_t status = sizeStatus(out); status != HAPTO_OK) {
    return status;
  }
  return withTool(scene, tool, out, [&](const SceneObject& object) {
    give(stateOf(object, tool), *out);
    return HAPTO_OK;
  });
}

// Saves a scene, and continues a saved one.

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/scene/scene.h"

namespace haptolith {

namespace {

constexpr std::array<char, 8> kMagic{'H', 'A', 'P', 'S', 'C', 'N', '0', '3'};

/// A tool's numbers, so that its bytes are its value; what it remembers follows.
struct Record {
  std::array<double, 3> position_m{};
  std::array<double, 4> orientation{};  ///< w x y z
  double opening = 0, opening_m = 0, fade = 0, grip_n = 0;
  std::array<double, 3> force_n{}, torque_nm{};
  std::array<double, 9> contact_stiffness_n_m{};  ///< column by column
  std::array<double, 4> joint{};                  ///< JointState, in its order
  std::uint64_t particles = 0, spheres = 0, near_groups = 0;
};

template <std::size_t kCount>
bool areFinite(const std::array<double, kCount>& numbers) {
  return Eigen::Map<const Eigen::Array<double, static_cast<int>(kCount), 1>>(numbers.data()).isFinite().all();
}

Record recordOf(const SavedTool& tool) {
  Record record{
      .opening = tool.hand.opening,
      .opening_m = tool.opening_m,
      .fade = tool.fade,
      .grip_n = tool.soil_force.grip_n,
      .joint = {tool.joint.angle_rad, tool.joint.speed_rad_s, tool.joint.soil_torque_nm, tool.joint.motor_torque_nm},
      .particles = tool.memory.particles.size(),
      .spheres = tool.memory.spheres.size(),
      .near_groups = tool.memory.near_groups.size()};
  const Quat& turn = tool.hand.pose.orientation;
  record.orientation = {turn.w(), turn.x(), turn.y(), turn.z()};
  Vec3::Map(record.position_m.data()) = tool.hand.pose.position_m;
  Vec3::Map(record.force_n.data()) = tool.soil_force.wrench.force_n;
  Vec3::Map(record.torque_nm.data()) = tool.soil_force.wrench.torque_nm;
  Eigen::Matrix3d::Map(record.contact_stiffness_n_m.data()) = tool.contact_stiffness_n_m;
  return record;
}

void requireFinite(const SavedTool& tool) {
  const Record r = recordOf(tool);
  const bool finite = areFinite(r.position_m) && areFinite(r.orientation) && areFinite(r.force_n) &&
                      areFinite(r.torque_nm) && areFinite(r.contact_stiffness_n_m) && areFinite(r.joint) &&
                      areFinite(std::array{r.opening, r.opening_m, r.fade, r.grip_n});
  if (!finite || !isUnit(tool.hand.pose.orientation)) {
    throw InvalidParameter("state", "a tool without a finite pose", "finite numbers, and an orientation of norm 1");
  }
  requireInRange("tool_fade", tool.fade, {0, 1});
  requireInRange("opening", tool.hand.opening, {0, 1});
  requireInRange("joint_angle_rad", tool.joint.angle_rad, {-std::numbers::pi, std::numbers::pi});
  requireInRange("joint_speed_rad_s", tool.joint.speed_rad_s, JointRanges::speed_rad_s);
  requireInRange("opening_m", tool.opening_m, {0, ToolRanges::length_m.highest});
}

template <class Value>
void append(std::string& bytes, const std::vector<Value>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

template <class Value>
std::vector<Value> take(std::string_view& bytes, std::uint64_t count) {
  if (count > bytes.size() / sizeof(Value)) {
    throw Failure("this saved scene is damaged: its tools are truncated");
  }
  std::vector<Value> values(count);
  if (count > 0) {
    std::memcpy(values.data(), bytes.data(), count * sizeof(Value));
  }
  bytes.remove_prefix(count * sizeof(Value));
  return values;
}

SavedTool takeTool(std::string_view& bytes) {
  const Record record = take<Record>(bytes, 1)[0];
  const auto& turn = record.orientation;
  SavedTool tool{.hand = {},
                 .opening_m = record.opening_m,
                 .fade = record.fade,
                 .soil_force = {{Vec3::Map(record.force_n.data()), Vec3::Map(record.torque_nm.data())}, record.grip_n},
                 .contact_stiffness_n_m = Eigen::Matrix3d::Map(record.contact_stiffness_n_m.data()),
                 .joint = {record.joint[0], record.joint[1], record.joint[2], record.joint[3]},
                 .memory = {}};
  tool.hand.pose = {Vec3::Map(record.position_m.data()), Quat(turn[0], turn[1], turn[2], turn[3])};
  tool.hand.opening = record.opening;
  tool.memory.particles = take<SavedToolMemory::Particle>(bytes, record.particles);
  tool.memory.spheres = take<SavedToolMemory::Sphere>(bytes, record.spheres);
  tool.memory.near_groups = take<std::uint32_t>(bytes, record.near_groups);
  return tool;
}

}  // namespace

std::string serialise(const SavedScene& saved) {
  std::string bytes(kMagic.data(), kMagic.size());
  append(bytes, std::vector<std::uint64_t>{saved.tools.size()});
  for (const SavedTool& tool : saved.tools) {
    append(bytes, std::vector<Record>{recordOf(tool)});
    append(bytes, tool.memory.particles);
    append(bytes, tool.memory.spheres);
    append(bytes, tool.memory.near_groups);
  }
  return bytes + serialise(saved.bed);
}

SavedScene deserialiseSavedScene(std::string_view bytes) {
  if (!bytes.starts_with(std::string_view(kMagic.data(), kMagic.size()))) {
    throw Failure("not a saved scene, or saved by another version");
  }
  bytes.remove_prefix(kMagic.size());
  const std::uint64_t tools = take<std::uint64_t>(bytes, 1)[0];
  if (tools > ToolSet::kMost) {
    throw Failure("this saved scene is damaged: it has too many tools");
  }
  SavedScene saved;
  for (std::uint64_t i = 0; i < tools; ++i) {
    saved.tools.push_back(takeTool(bytes));
  }
  saved.bed = deserialiseSavedBed(bytes);
  return saved;
}

Scene::Scene(const BedParameters& bed, const ToolSet& tools, const SavedScene& saved)
    : substeps_(substepsOf(bed, tools)), bed_(bed, saved.bed) {
  makeTools(tools);
  requireSound(saved);
  recallTools(saved);
}

SavedScene Scene::save() const {
  SavedScene saved{.bed = bed_.save(), .tools = {}};
  for (const Tool& tool : tools_) {
    saved.tools.push_back({.hand = {{tool.pose, {}}, tool.opening},
                           .opening_m = tool.opening_m,
                           .fade = tool.fade,
                           .soil_force = tool.soil_force,
                           .contact_stiffness_n_m = tool.stiffness_n_m,
                           .joint = tool.joint,
                           .memory = tool.memory.save()});
  }
  return saved;
}

void Scene::requireSound(const SavedScene& saved) const {
  if (saved.tools.size() != tools_.size()) {
    throw InvalidParameter("state", fmt::format("{} tools", saved.tools.size()),
                           fmt::format("this scene's {}", tools_.size()));
  }
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    requireFinite(saved.tools[i]);
    tools_[i].memory.requireSound(saved.tools[i].memory);
  }
}

void Scene::restore(const SavedScene& saved) {
  requireSound(saved);
  bed_.restore(saved.bed);
  recallTools(saved);
}

void Scene::recallTools(const SavedScene& saved) noexcept {
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    tools_[i].recall(saved.tools[i]);
  }
}

void Scene::Tool::recall(const SavedTool& saved) noexcept {
  pose = saved.hand.pose;
  opening = saved.hand.opening;
  opening_m = saved.opening_m;
  fade = saved.fade;
  soil_force = saved.soil_force;
  stiffness_n_m = saved.contact_stiffness_n_m;
  joint = saved.joint;
  memory.restore(saved.memory);
  recent_force.restart();
}

}  // namespace haptolith

// Saves a scene, and continues a saved one.

#include <array>
#include <cstring>

#include "haptolith/core/error.h"
#include "haptolith/scene/scene.h"

namespace haptolith {

namespace {

constexpr std::array<char, 8> kMagic{'H', 'A', 'P', 'S', 'C', 'N', '0', '1'};

/// Saved data in addition to the bed. Numbers only, so that its bytes are its value.
struct Record {
  std::array<char, 8> magic{};
  std::array<double, 3> position_m{};
  std::array<double, 4> orientation{};  ///< w x y z
  double opening = 0, opening_m = 0, tool_fade = 0, grip_n = 0;
  std::array<double, 3> force_n{}, torque_nm{};
  std::array<double, 9> contact_stiffness_n_m{};  ///< column by column
};

template <std::size_t kCount>
bool areFinite(const std::array<double, kCount>& numbers) {
  return Eigen::Map<const Eigen::Array<double, static_cast<int>(kCount), 1>>(numbers.data()).isFinite().all();
}

Record recordOf(const SavedScene& saved) {
  Record record{.magic = kMagic,
                .opening = saved.tool.opening,
                .opening_m = saved.opening_m,
                .tool_fade = saved.tool_fade,
                .grip_n = saved.soil_force.grip_n};
  const Quat& turn = saved.tool.pose.orientation;
  record.orientation = {turn.w(), turn.x(), turn.y(), turn.z()};
  Vec3::Map(record.position_m.data()) = saved.tool.pose.position_m;
  Vec3::Map(record.force_n.data()) = saved.soil_force.wrench.force_n;
  Vec3::Map(record.torque_nm.data()) = saved.soil_force.wrench.torque_nm;
  Eigen::Matrix3d::Map(record.contact_stiffness_n_m.data()) = saved.contact_stiffness_n_m;
  return record;
}

void requireFinite(const SavedScene& saved) {
  const Record r = recordOf(saved);
  const bool finite = areFinite(r.position_m) && areFinite(r.orientation) && areFinite(r.force_n) &&
                      areFinite(r.torque_nm) && areFinite(r.contact_stiffness_n_m) &&
                      areFinite(std::array{r.opening, r.opening_m, r.tool_fade, r.grip_n});
  if (!finite || !isUnit(saved.tool.pose.orientation)) {
    throw InvalidParameter("state", "a tool without a finite pose", "finite numbers, and an orientation of norm 1");
  }
  requireInRange("tool_fade", saved.tool_fade, {0, 1});
  requireInRange("opening", saved.tool.opening, {0, 1});
  requireInRange("opening_m", saved.opening_m, {0, ToolRanges::length_m.highest});
}

}  // namespace

std::string serialise(const SavedScene& saved) {
  const Record record = recordOf(saved);
  return std::string(reinterpret_cast<const char*>(&record), sizeof record) + serialise(saved.bed);
}

SavedScene deserialiseSavedScene(std::string_view bytes) {
  Record record;
  if (bytes.size() < sizeof record) {
    throw Failure("not a saved scene: shorter than the header");
  }
  std::memcpy(&record, bytes.data(), sizeof record);
  if (record.magic != kMagic) {
    throw Failure("not a saved scene, or saved by another version");
  }
  SavedScene saved{.bed = deserialiseSavedBed(bytes.substr(sizeof record)),
                   .tool = {},
                   .opening_m = record.opening_m,
                   .tool_fade = record.tool_fade,
                   .soil_force = {}};
  const auto& turn = record.orientation;
  saved.tool.pose = {Vec3::Map(record.position_m.data()), Quat(turn[0], turn[1], turn[2], turn[3])};
  saved.tool.opening = record.opening;
  saved.soil_force = {{Vec3::Map(record.force_n.data()), Vec3::Map(record.torque_nm.data())}, record.grip_n};
  saved.contact_stiffness_n_m = Eigen::Matrix3d::Map(record.contact_stiffness_n_m.data());
  return saved;
}

Scene::Scene(const BedParameters& bed, const ToolParameters& tool, const SavedScene& saved)
    : tool_(tool), substeps_(substepsOf(bed, tool)), bed_(bed, saved.bed), opening_m_(tool.opening_m) {
  requireFinite(saved);
  recallTool(saved);
}

SavedScene Scene::save() const {
  return {.bed = bed_.save(),
          .tool = {{tool_pose_, {}}, opening_},
          .opening_m = opening_m_,
          .tool_fade = tool_fade_,
          .soil_force = soil_force_,
          .contact_stiffness_n_m = stiffness_n_m_};
}

void Scene::restore(const SavedScene& saved) {
  requireFinite(saved);
  bed_.restore(saved.bed);
  recallTool(saved);
}

void Scene::recallTool(const SavedScene& saved) noexcept {
  tool_pose_ = saved.tool.pose;
  opening_ = saved.tool.opening;
  opening_m_ = saved.opening_m;
  tool_fade_ = saved.tool_fade;
  soil_force_ = saved.soil_force;
  stiffness_n_m_ = saved.contact_stiffness_n_m;
}

}  // namespace haptolith

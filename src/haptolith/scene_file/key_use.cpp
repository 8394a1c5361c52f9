#include "haptolith/scene_file/key_use.h"

#include <array>
#include <vector>

namespace haptolith {

namespace {

bool isIcra2021(const SceneFile& scene) {
  return scene.bed.soil.friction == FrictionModel::kIcra2021;
}

bool hasContactFriction(const SceneFile& scene) {
  return scene.bed.soil.friction == FrictionModel::kContact;
}

template <BedStart... kStarts>
bool starts(const SceneFile& scene) {
  return ((scene.bed.start == kStarts) || ...);
}

bool isGraded(const SceneFile& scene) {
  return hasContactFriction(scene) && scene.bed.grading.fine_radius_m > 0;
}

bool needsSeed(const SceneFile& scene) {
  return starts<BedStart::kRain, BedStart::kSettled>(scene) || isGraded(scene);
}

template <ToolShape... kShapes>
bool isShape(const SceneFile& scene) {
  return ((scene.tool.shape == kShapes) || ...);
}

bool isBuiltInMotion(const SceneFile& scene) {
  return scene.hand.motion != HandMotion::kPoses;
}

bool hasRandomStones(const SceneFile& scene) {
  return scene.bed.stones.count > 0;
}

bool hasStones(const SceneFile& scene) {
  return scene.bed.stones.any();
}

bool isArm(const SceneFile& scene) {
  return scene.hand.compliance == HandCompliance::kArm;
}

bool isNotDirect(const SceneFile& scene) {
  return scene.handling.coupling.kind != CouplingKind::kDirect;
}

template <Drive... kDrives>
bool drives(const SceneFile& scene) {
  return ((scene.tool.joint.drive == kDrives) || ...);
}

bool hasJoint(const SceneFile& scene) {
  return scene.tool.joint.any();
}

constexpr std::string_view kJoint = "[tool] joint_drive = speed, torque or free";
constexpr std::string_view kIcra2021 = "[soil] friction_model = icra2021";
constexpr std::string_view kContact = "[soil] friction_model = contact";
constexpr std::string_view kGraded = "[bed] fine_radius_mm above 0";
constexpr std::string_view kStones = "[stones] count above 0";
constexpr std::string_view kAnyStones = "[stones] count above 0, or a [[stone]]";
constexpr std::string_view kMesh = "[tool] mesh";
constexpr std::string_view kArm = "[hand] compliance = arm";
constexpr std::string_view kNoPoses = "another [hand] motion than poses";
constexpr std::string_view kNotDirect = "[coupling] kind = auto or virtual";

/// All but those of [soil].
constexpr std::array kUses{
    // A named soil of the command line or the page makes a bed that starts as `count` start as `rain`.
    KeyUse{"bed", "particles", starts<BedStart::kCount, BedStart::kRain>, "[bed] start = count or rain", false},
    KeyUse{"bed", "layers", starts<BedStart::kCount>, "[bed] start = count", false},
    KeyUse{"bed", "depth_mm", starts<BedStart::kPacked, BedStart::kSettled>, "[bed] start = packed or settled", false},
    KeyUse{"bed", "grains", starts<BedStart::kGiven>, "[bed] start = given", false},
    KeyUse{"bed", "seed", needsSeed, "[bed] start = rain or settled, or fine_radius_mm", true},
    KeyUse{"bed", "ready_made", starts<BedStart::kSettled>, "[bed] start = settled", true},
    KeyUse{"bed", "fine_radius_mm", hasContactFriction, kContact, true},
    KeyUse{"bed", "fine_width_mm", isGraded, kGraded, true},
    KeyUse{"bed", "fine_length_mm", isGraded, kGraded, true},
    KeyUse{"bed", "fine_depth_mm", isGraded, kGraded, true},
    KeyUse{"bed", "fine_x_mm", isGraded, kGraded, true},
    KeyUse{"bed", "fine_y_mm", isGraded, kGraded, true},

    KeyUse{"stones", "shape", hasRandomStones, kStones, true},
    KeyUse{"stones", "smallest_mm", hasRandomStones, kStones, true},
    KeyUse{"stones", "largest_mm", hasRandomStones, kStones, true},
    KeyUse{"stones", "exponent", hasRandomStones, kStones, true},
    KeyUse{"stones", "shallowest_mm", hasRandomStones, kStones, true},
    KeyUse{"stones", "deepest_mm", hasRandomStones, kStones, true},
    KeyUse{"stones", "seed", hasRandomStones, kStones, true},
    KeyUse{"stones", "fixed", hasRandomStones, kStones, true},
    KeyUse{"stones", "density_kg_m3", hasStones, kAnyStones, true},

    KeyUse{"tool", "size_mm", isShape<ToolShape::kBox, ToolShape::kJaws>, "[tool] shape = box or jaws", true},
    KeyUse{"tool", "diameter_mm", isShape<ToolShape::kSphere, ToolShape::kPlate, ToolShape::kCylinder>,
           "[tool] shape = sphere, plate or cylinder", true},
    KeyUse{"tool", "thickness_mm", isShape<ToolShape::kPlate>, "[tool] shape = plate", true},
    KeyUse{"tool", "length_mm", isShape<ToolShape::kCylinder>, "[tool] shape = cylinder", true},
    KeyUse{"tool", "mesh_unit_mm", isShape<ToolShape::kMesh>, kMesh, true},
    KeyUse{"tool", "mesh_sheet_mm", isShape<ToolShape::kMesh>, kMesh, true},
    KeyUse{"tool", "mesh_origin_mm", isShape<ToolShape::kMesh>, kMesh, true},
    KeyUse{"tool", "mesh_turn_deg", isShape<ToolShape::kMesh>, kMesh, true},
    KeyUse{"tool", "opening_mm", isShape<ToolShape::kJaws>, "[tool] shape = jaws", true},
    KeyUse{"tool", "jaw_bend_deg", isShape<ToolShape::kJaws>, "[tool] shape = jaws", true},
    KeyUse{"tool", "adhesion_ratio", isIcra2021, kIcra2021, true},
    KeyUse{"tool", "friction", hasContactFriction, kContact, true},
    KeyUse{"tool", "adhesion_n", hasContactFriction, kContact, true},

    KeyUse{"tool", "joint_axis", hasJoint, kJoint, true},
    KeyUse{"tool", "joint_point_mm", hasJoint, kJoint, true},
    KeyUse{"tool", "joint_speed_rad_s", hasJoint, kJoint, true},
    KeyUse{"tool", "joint_torque_nm", drives<Drive::kTorque>, "[tool] joint_drive = torque", true},
    KeyUse{"tool", "joint_inertia_kg_m2", drives<Drive::kTorque, Drive::kFree>, "[tool] joint_drive = torque or free",
           true},

    KeyUse{"hand", "mass_kg", isArm, kArm, false},
    KeyUse{"hand", "damping_n_s_m", isArm, kArm, false},
    KeyUse{"hand", "stiffness_n_m", isArm, kArm, false},
    KeyUse{"hand", "lever_mm", isArm, kArm, false},
    KeyUse{"hand", "period_s", isBuiltInMotion, kNoPoses, true},
    KeyUse{"hand", "turn_deg", isBuiltInMotion, kNoPoses, true},
    KeyUse{"hand", "depth_mm", isBuiltInMotion, kNoPoses, true},
    KeyUse{"hand", "reach_mm", isBuiltInMotion, kNoPoses, true},

    KeyUse{"coupling", "stiffness_n_m", isNotDirect, kNotDirect, false},
    KeyUse{"coupling", "damping_n_s_m", isNotDirect, kNotDirect, false},
    KeyUse{"coupling", "mass_kg", isNotDirect, kNotDirect, false},
    KeyUse{"coupling", "lever_mm", isNotDirect, kNotDirect, false},
    KeyUse{"coupling", "max_force_n", isNotDirect, kNotDirect, false},
};

}  // namespace

std::span<const KeyUse> keyUses() {
  static const std::vector<KeyUse> kAll = [] {
    std::vector<KeyUse> uses;
    for (const SoilNumber& number : kSoilNumbers) {
      if (number.model == FrictionModel::kIcra2021) {
        uses.push_back({"soil", number.key, isIcra2021, kIcra2021, true});
      } else if (number.model == FrictionModel::kContact) {
        uses.push_back({"soil", number.key, hasContactFriction, kContact, true});
      }
    }
    uses.insert(uses.end(), kUses.begin(), kUses.end());
    return uses;
  }();
  return kAll;
}

}  // namespace haptolith

#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/device/device_parameters.h"
#include "haptolith/device/hand/hand_parameters.h"
#include "haptolith/haptics/coupling.h"
#include "haptolith/mesh/mesh_file.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/scene_file/toml/key_words.h"
#include "haptolith/soil/soil_parameters.h"
#include "haptolith/stone/stone_parameters.h"
#include "haptolith/tool/tool_parameters.h"
#include "haptolith/tool/tool_part.h"

namespace haptolith {

inline constexpr std::array kFrictionWords{
    SceneWord{"icra2021", FrictionModel::kIcra2021},
    SceneWord{"contact", FrictionModel::kContact},
};

inline constexpr std::array kSoilStrengthWords{
    SceneWord{"residual", SoilStrength::kResidual},
    SceneWord{"peak", SoilStrength::kPeak},
};

inline constexpr std::array kBedStartWords{
    SceneWord{"count", BedStart::kCount}, SceneWord{"packed", BedStart::kPacked},
    SceneWord{"rain", BedStart::kRain},   SceneWord{"settled", BedStart::kSettled},
    SceneWord{"given", BedStart::kGiven},
};

inline constexpr std::array kStoneFormWords{
    SceneWord{"rock", StoneForm::kRock},
    SceneWord{"sphere", StoneForm::kSphere},
    SceneWord{"spheres", StoneForm::kSpheres},
};

inline constexpr std::array kToolPartWords{
    SceneWord{"box", ToolPartForm::kBox},
    SceneWord{"sphere", ToolPartForm::kSphere},
    SceneWord{"cylinder", ToolPartForm::kCylinder},
};

inline constexpr std::array kToolShapeWords{
    SceneWord{"box", ToolShape::kBox},     SceneWord{"sphere", ToolShape::kSphere},
    SceneWord{"plate", ToolShape::kPlate}, SceneWord{"cylinder", ToolShape::kCylinder},
    SceneWord{"jaws", ToolShape::kJaws},   SceneWord{"mesh", ToolShape::kMesh},
};

inline constexpr std::array kDriveWords{
    SceneWord{"none", Drive::kNone},
    SceneWord{"speed", Drive::kSpeed},
    SceneWord{"torque", Drive::kTorque},
    SceneWord{"free", Drive::kFree},
};

inline constexpr std::array kMeshFormatWords{
    SceneWord{"stl", MeshFormat::kStl},
    SceneWord{"obj", MeshFormat::kObj},
    SceneWord{"gltf", MeshFormat::kGltf},
};

inline constexpr std::array kHandMotionWords{
    SceneWord{"still", HandMotion::kStill}, SceneWord{"press", HandMotion::kPress},
    SceneWord{"stir", HandMotion::kStir},   SceneWord{"scoop", HandMotion::kScoop},
    SceneWord{"carry", HandMotion::kCarry}, SceneWord{"shake", HandMotion::kShake},
    SceneWord{"cut", HandMotion::kCut},     SceneWord{"furrows", HandMotion::kFurrows},
    SceneWord{"poses", HandMotion::kPoses},
};

inline constexpr std::array kDeviceWords{
    SceneWord{"virtual-hand", DeviceKind::kVirtualHand}, SceneWord{"force-dimension", DeviceKind::kForceDimension},
    SceneWord{"inverse3", DeviceKind::kInverse3},        SceneWord{"spacemouse", DeviceKind::kSpaceMouse},
    SceneWord{"gamepad", DeviceKind::kGamepad},          SceneWord{"mouse", DeviceKind::kMouse},
    SceneWord{"network", DeviceKind::kNetwork},
};

inline constexpr std::array kCouplingWords{
    SceneWord{"auto", CouplingKind::kAuto},
    SceneWord{"direct", CouplingKind::kDirect},
    SceneWord{"virtual", CouplingKind::kVirtual},
};

inline constexpr std::array kHandComplianceWords{
    SceneWord{"arm", HandCompliance::kArm},
    SceneWord{"rigid", HandCompliance::kRigid},
};

/// Motions of the virtual hand that can be chosen while a scene runs: all except recorded poses, which need a file.
[[nodiscard]] inline std::vector<std::string_view> playableMotions() {
  std::vector<std::string_view> names = namesOf(kHandMotionWords);
  std::erase(names, "poses");
  return names;
}

}  // namespace haptolith

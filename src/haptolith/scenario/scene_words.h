#pragma once

#include <array>
#include <string_view>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/device/hand_parameters.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// A word of the scene files and the command line, and what it stands for.
template <class Value>
struct SceneWord {
  std::string_view name;
  Value value;
};

template <class Value>
SceneWord(const char*, Value) -> SceneWord<Value>;  // clang 14 does not find it by itself

inline constexpr std::array kBedStartWords{
    SceneWord{"count", BedStart::kCount},
    SceneWord{"packed", BedStart::kPacked},
    SceneWord{"rain", BedStart::kRain},
};

inline constexpr std::array kToolShapeWords{
    SceneWord{"box", ToolShape::kBox},
    SceneWord{"sphere", ToolShape::kSphere},
    SceneWord{"plate", ToolShape::kPlate},
};

inline constexpr std::array kManoeuvreWords{
    SceneWord{"still", Manoeuvre::kStill}, SceneWord{"press", Manoeuvre::kPress}, SceneWord{"stir", Manoeuvre::kStir},
    SceneWord{"scoop", Manoeuvre::kScoop}, SceneWord{"carry", Manoeuvre::kCarry}, SceneWord{"shake", Manoeuvre::kShake},
    SceneWord{"poses", Manoeuvre::kPoses},
};

inline constexpr std::array kHandComplianceWords{
    SceneWord{"arm", HandCompliance::kArm},
    SceneWord{"rigid", HandCompliance::kRigid},
};

}  // namespace haptolith

#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "haptolith/scene_file/scene_words.h"

namespace haptolith {

/// Task for the operator at a robot's site.
enum class SiteTask : std::uint8_t {
  kTrench,  ///< a trench, as wide as the tool
  kPress,   ///< the tool's large face pressed on the soil
  kScoop,   ///< a load on the tool
};

inline constexpr std::array kSiteTaskWords{
    SceneWord{"trench", SiteTask::kTrench},
    SceneWord{"press", SiteTask::kPress},
    SceneWord{"scoop", SiteTask::kScoop},
};

/// When it is done.
struct SiteTaskGoals {
  static constexpr double trench_depth_m = 0.04;
  static constexpr double trench_length_m = 0.06;
  static constexpr double trench_width_m = 0.024;  ///< over which the depth counts: half of the tool's
  static constexpr double press_n = 8;
  static constexpr double press_within = 0.1;  ///< as a share
  static constexpr double load_n = 0.1;        ///< on the Moon 44 cm3 of soil
};

/// In a sentence: "Dig a trench, 40 mm deep and 60 mm long".
[[nodiscard]] std::string goalOf(SiteTask task);

/// Progress of the task: "23 of 40 mm". @param reached  depth in m, or force in N; NaN: not known.
[[nodiscard]] std::string reachedText(SiteTask task, double reached);

}  // namespace haptolith

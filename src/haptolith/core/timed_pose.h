#pragma once

#include "haptolith/core/vec.h"

namespace haptolith {

/// Where something is at a time. A list of them names its frame.
struct TimedPose {
  double time_s = 0;
  Pose pose;
};

}  // namespace haptolith

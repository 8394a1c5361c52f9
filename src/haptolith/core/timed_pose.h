#pragma once

#include "haptolith/core/vec.h"

namespace haptolith {

/// Pose of a body at a time, in the frame that the list or the file names.
struct TimedPose {
  double time_s = 0;
  Pose pose;
};

}  // namespace haptolith

#pragma once

#include <string>

#include "haptolith/haptics/haptic_loop.h"

namespace haptolith {

/// Writes the last ticks before the hand was let go to a new CSV file where the program was started, and returns its
/// name. @throws Failure when that cannot be done.
std::string writeTripFile(const TripReport& report);

}  // namespace haptolith

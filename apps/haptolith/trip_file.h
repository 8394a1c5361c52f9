#pragma once

#include <string>

#include "haptolith/session/session.h"

#include "output.h"
#include "recording.h"

namespace haptolith {

/// When the safety layer has let go of the hand since the last call: says why, notes it in the recording, and writes
/// the last ticks before it to a new CSV file where the program was started.
/// @return what it has told; empty: there was nothing to tell.
std::string tellOfTrips(Session& session, StatusLine& status, Recording& recording);

}  // namespace haptolith

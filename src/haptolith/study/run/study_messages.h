#pragma once

#include <string>
#include <string_view>

#include "haptolith/study/run/conductor.h"

namespace haptolith {

/// The messages of a study between program and pages: docs/reference/web-protocol.md.

enum class StudyRole { kParticipant, kExperimenter };

/// Everything that a participant may see: nothing that tells one stimulus from another.
[[nodiscard]] std::string participantMessage(const Conductor& conductor);

/// Answers, curves and notes so far, which are new only when Conductor::changes() has counted up: an object.
[[nodiscard]] std::string historyJson(const Conductor& conductor);

/// @param history  historyJson(), perhaps of a moment ago.
[[nodiscard]] std::string experimenterMessage(const Conductor& conductor, std::string_view history, double force_n,
                                              double peak_force_n);

/// Does what a page asks for. It has its role from the address it came by: "join" says that it is ready, and which page
/// it is.
/// @return whether it has joined.
/// @throws InvalidParameter for an invalid message, or one that this role may not send now.
bool handleStudyMessage(Conductor& conductor, std::string_view text, StudyRole role, bool joined);

}  // namespace haptolith

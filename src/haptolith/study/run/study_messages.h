#pragma once

#include <string>
#include <string_view>

#include "haptolith/study/run/conductor.h"

namespace haptolith {

// Messages of a study between program and pages: docs/reference/web-protocol.md.

enum class StudyRole { kParticipant, kExperimenter };

/// Returns the message for the participant, without information that distinguishes stimuli.
[[nodiscard]] std::string participantMessage(const Conductor& conductor);

/// Returns responses, curves and notes so far, as an object. It changes only with Conductor::changes().
[[nodiscard]] std::string historyJson(const Conductor& conductor);

/// Returns the message for the experimenter. @param history  historyJson(), which may be slightly older.
[[nodiscard]] std::string experimenterMessage(const Conductor& conductor, std::string_view history, double force_n,
                                              double peak_force_n);

/// Carries out a page's request. The page's role follows from its address; "join" reports that it is ready, and which
/// page it is.
/// @return whether it has joined.
/// @throws InvalidParameter for an invalid message, or one that this role may not send now.
bool handleStudyMessage(Conductor& conductor, std::string_view text, StudyRole role, bool joined);

}  // namespace haptolith

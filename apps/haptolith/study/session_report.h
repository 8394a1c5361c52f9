#pragma once

#include <nlohmann/json.hpp>

#include <string>

#include "haptolith/study/store/store.h"

namespace haptolith {

/// Returns the sessions of a study as text: one line per kind, program and machine. Empty without sessions.
[[nodiscard]] std::string sessionsText(const StudyStore& study);

/// Returns every session of a participant.
[[nodiscard]] nlohmann::ordered_json sessionsJson(const StudyStore& study, const ParticipantRow& participant);

/// Returns the consent of a participant; null without any.
[[nodiscard]] nlohmann::ordered_json consentJson(const StudyStore& study, const ParticipantRow& participant);

/// Returns removals that were not finished; empty without any.
[[nodiscard]] std::string pendingText(const StudyStore& study);

}  // namespace haptolith

#pragma once

#include <nlohmann/json.hpp>

#include <string>

#include "haptolith/study/store/store.h"

namespace haptolith {

/// What ran the study, for a person: sessions of one kind by one program on one machine in one line. Empty: none did.
[[nodiscard]] std::string sessionsText(const StudyStore& study);

/// Every session of a participant.
[[nodiscard]] nlohmann::ordered_json sessionsJson(const StudyStore& study, const ParticipantRow& participant);

/// What a participant has agreed to; null: nothing.
[[nodiscard]] nlohmann::ordered_json consentJson(const StudyStore& study, const ParticipantRow& participant);

/// Removals that were begun and not finished; empty: none was.
[[nodiscard]] std::string pendingText(const StudyStore& study);

}  // namespace haptolith

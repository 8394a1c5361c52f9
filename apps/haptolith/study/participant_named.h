#pragma once

#include <string_view>

#include "haptolith/study/store/store.h"

namespace haptolith {

/// Returns the participant with that code. @throws InvalidParameter with all codes for an unknown code.
[[nodiscard]] ParticipantRow participantNamed(const StudyStore& study, std::string_view code);

}  // namespace haptolith

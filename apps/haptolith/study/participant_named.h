#pragma once

#include <string_view>

#include "haptolith/study/store/store.h"

namespace haptolith {

/// The participant with that code. @throws InvalidParameter that lists all codes when there is none.
[[nodiscard]] ParticipantRow participantNamed(const StudyStore& study, std::string_view code);

}  // namespace haptolith

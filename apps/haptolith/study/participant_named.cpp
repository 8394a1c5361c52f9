#include "study/participant_named.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {

ParticipantRow participantNamed(const StudyStore& study, std::string_view code) {
  const std::vector<ParticipantRow> participants = study.participants();
  const auto found = std::ranges::find(participants, code, &ParticipantRow::code);
  if (found == participants.end()) {
    std::vector<std::string> codes;
    std::ranges::transform(participants, std::back_inserter(codes), &ParticipantRow::code);
    throw InvalidParameter("participant", fmt::format("'{}'", code),
                           codes.empty() ? "the code of a participant; the study has no participants"
                                         : fmt::format("one of {}", fmt::join(codes, ", ")));
  }
  return *found;
}

}  // namespace haptolith

#include "haptolith/study/store/participant_flow.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

namespace haptolith {

ParticipantFlow flowOf(const StudyStore& study) {
  ParticipantFlow flow;
  flow.removed = static_cast<std::size_t>(std::ranges::count_if(study.removals(), [](const RemovalRow& row) {
    return row.what == Removed::kEverything && !row.done_at.empty();
  }));
  for (const ParticipantRow& participant : study.participants()) {
    if (participant.state == "withdrawn") {
      ++flow.withdrew;
    } else if (!participant.excluded_for.empty()) {
      ++flow.excluded;
      ++flow.reasons[participant.excluded_for];
    } else {
      ++(participant.state == "finished" ? flow.finished : flow.unfinished);
    }
  }
  return flow;
}

std::string flowText(const ParticipantFlow& flow) {
  std::vector<std::string> parts{fmt::format("{} began", flow.began())};
  if (flow.removed > 0) {
    parts.push_back(fmt::format("{} removed on request", flow.removed));
  }
  if (flow.withdrew > 0) {
    parts.push_back(fmt::format("{} withdrew", flow.withdrew));
  }
  if (flow.excluded > 0) {
    std::vector<std::string> reasons;
    for (const auto& [reason, people] : flow.reasons) {
      reasons.push_back(people == flow.excluded ? reason : fmt::format("{}: {}", reason, people));
    }
    parts.push_back(fmt::format("{} excluded ({})", flow.excluded, fmt::join(reasons, "; ")));
  }
  parts.push_back(fmt::format("{} analysed{}", flow.analysed(),
                              flow.unfinished > 0 ? fmt::format(" ({} not finished)", flow.unfinished) : ""));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace haptolith

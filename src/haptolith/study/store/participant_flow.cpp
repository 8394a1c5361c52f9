#include "haptolith/study/store/participant_flow.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "haptolith/study/protocol/groups.h"

namespace haptolith {

namespace {

void count(ParticipantFlow& flow, const ParticipantRow& participant) {
  if (participant.state == "withdrawn") {
    ++flow.withdrew;
  } else if (!participant.excluded_for.empty()) {
    ++flow.excluded;
    ++flow.reasons[participant.excluded_for];
  } else {
    ++(participant.state == "finished" ? flow.finished : flow.unfinished);
  }
}

}  // namespace

ParticipantFlow flowOf(const StudyStore& study) {
  ParticipantFlow flow;
  flow.removed = static_cast<std::size_t>(std::ranges::count_if(study.removals(), [](const RemovalRow& row) {
    return row.what == Removed::kEverything && !row.done_at.empty();
  }));
  for (const ParticipantRow& participant : study.participants()) {
    count(flow, participant);
  }
  return flow;
}

std::vector<GroupFlow> groupFlowsOf(const StudyStore& study) {
  const StudyProtocol& protocol = study.protocol();
  const std::vector<int> given = study.placesGiven();
  std::vector<GroupFlow> flows;
  for (const ParticipantGroup& group : protocol.groups) {
    GroupFlow& flow = flows.emplace_back();
    flow.group = group.name;
    flow.strata.resize(given.size());
  }
  for (std::size_t stratum = 0; stratum < given.size() && !flows.empty(); ++stratum) {
    for (int place = 0; place < given[stratum]; ++place) {
      GroupFlow& flow = flows[groupAt(protocol, study.seed(), stratum, static_cast<std::size_t>(place))];
      ++flow.strata[stratum];
      ++flow.people.removed;  // decremented below for each participant who has a place
    }
  }
  for (const ParticipantRow& participant : study.participants()) {
    if (participant.assignment) {
      GroupFlow& flow = *std::ranges::find(flows, participant.assignment->group, &GroupFlow::group);
      count(flow.people, participant);
      --flow.people.removed;
    }
  }
  return flows;
}

std::string flowsText(const StudyStore& study) {
  std::string text = flowText(flowOf(study)) + "\n";
  for (const GroupFlow& flow : groupFlowsOf(study)) {
    text += fmt::format("  {}: {}\n", flow.group, flowText(flow.people, "assigned"));
  }
  return text;
}

std::string flowText(const ParticipantFlow& flow, std::string_view came) {
  std::vector<std::string> parts{fmt::format("{} {}", flow.began(), came)};
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

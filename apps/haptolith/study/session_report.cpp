#include "study/session_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "haptolith/core/pluralise.h"
#include "haptolith/study/store/provenance.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

/// Sessions under equal conditions.
struct Alike {
  std::size_t sessions = 0, unfinished = 0;
  SessionCounts counts = {};
  bool counted = false;
};

Json jsonOf(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

Json countOf(const SessionRow& session, std::uint64_t SessionCounts::*count) {
  return session.counts ? Json((*session.counts).*count) : Json(nullptr);
}

}  // namespace

std::string sessionsText(const StudyStore& study) {
  std::map<std::array<std::string, 4>, Alike> groups;
  for (const SessionRow& session : study.sessions()) {
    Alike& alike = groups[{session.kind, session.program_version, session.device,
                           fmt::format("{}, {}, {}", session.machine.os, session.machine.kernel, session.machine.cpu)}];
    ++alike.sessions;
    alike.unfinished += session.ended_at.empty() ? 1 : 0;
    if (session.counts) {
      alike.counted = true;
      alike.counts.ticks += session.counts->ticks;
      alike.counts.missed_ticks += session.counts->missed_ticks;
      alike.counts.safety_trips += session.counts->safety_trips;
    }
  }
  std::string text = groups.empty() ? "" : "\nSessions\n";
  for (const auto& [what, alike] : groups) {
    const auto& [kind, version, device, machine] = what;
    text += fmt::format("  {} {} by haptolith {}, {}; {}\n", alike.sessions, kind, version, device, machine);
    if (alike.counted) {
      text += fmt::format("    {} of {} late, safety trips: {}\n", alike.counts.missed_ticks,
                          pluralise(alike.counts.ticks, "tick"), alike.counts.safety_trips);
    }
    if (alike.unfinished > 0) {
      text += fmt::format("    {} running or interrupted\n", alike.unfinished);
    }
  }
  return text;
}

Json sessionsJson(const StudyStore& study, const ParticipantRow& participant) {
  Json rows = Json::array();
  for (const SessionRow& session : study.sessions()) {
    if (session.participant != participant.id) {
      continue;
    }
    rows.push_back(
        {{"kind", session.kind},
         {"begun_at", session.begun_at},
         {"ended_at", jsonOf(session.ended_at)},
         {"program_version", session.program_version},
         {"device", session.device},
         {"os", session.machine.os},
         {"kernel", session.machine.kernel},
         {"cpu", session.machine.cpu},
         {"loop_rate_hz", session.loop_rate_hz ? Json(*session.loop_rate_hz) : Json(nullptr)},
         {"ticks", countOf(session, &SessionCounts::ticks)},
         {"missed_ticks", countOf(session, &SessionCounts::missed_ticks)},
         {"safety_trips", countOf(session, &SessionCounts::safety_trips)},
         {"protocol_sha256", session.protocol_sha256},
         {"simulation", session.simulation.empty() ? Json(nullptr) : Json::parse(session.simulation, nullptr, false)}});
  }
  return rows;
}

Json consentJson(const StudyStore& study, const ParticipantRow& participant) {
  const std::vector<ConsentRow> consents = study.consents();
  const auto found = std::ranges::find(consents, participant.id, &ConsentRow::participant);
  return found == consents.end() ? Json(nullptr)
                                 : Json{{"at", found->at}, {"version", found->version}, {"language", found->language}};
}

std::string pendingText(const StudyStore& study) {
  std::string text;
  for (const RemovalRow& removal : study.removals()) {
    if (removal.done_at.empty()) {
      text += fmt::format(
          "\nA removal that began at {} is not completed: the next `haptolith study forget`, `run` or `resume` "
          "completes it.\n",
          removal.at);
    }
  }
  return text;
}

}  // namespace haptolith

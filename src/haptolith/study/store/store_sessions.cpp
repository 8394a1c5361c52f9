// Consents of participants, and sessions of a study.

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/store/provenance.h"
#include "haptolith/study/store/store.h"
#include "haptolith/study/store/store_file.h"
#include "haptolith/study/store/store_implementation.h"
#include "haptolith/study/store/study_sql.h"

namespace haptolith {

std::int64_t StudyStore::beginSession(std::int64_t participant, const SessionBegun& session) {
  SQLite::Database& database = *implementation_->database;
  return implementation_->write([&] {
    implementation_->requireParticipant(participant);
    execute(database,
            "INSERT INTO session (participant, kind, begun_at, program_version, device, os, kernel, cpu, loop_rate_hz, "
            "protocol_sha256, simulation) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
            participant, std::string_view(session.kind), std::string_view(nowText()),
            std::string_view(session.program_version), std::string_view(session.device),
            std::string_view(session.machine.os), std::string_view(session.machine.kernel),
            std::string_view(session.machine.cpu), session.loop_rate_hz,
            std::string_view(sha256Of(implementation_->protocol_text)), std::string_view(session.simulation));
    return database.getLastInsertRowid();
  });
}

void StudyStore::endSession(std::int64_t id, const std::optional<SessionCounts>& counts) {
  const auto number = [&](std::uint64_t SessionCounts::*member) {
    return counts ? std::optional(static_cast<std::int64_t>((*counts).*member)) : std::nullopt;
  };
  implementation_->write([&] {
    return execute(*implementation_->database,
                   "UPDATE session SET ended_at = ?, ticks = ?, missed_ticks = ?, safety_trips = ? WHERE id = ?",
                   std::string_view(nowText()), number(&SessionCounts::ticks), number(&SessionCounts::missed_ticks),
                   number(&SessionCounts::safety_trips), id);
  });
}

std::vector<SessionRow> StudyStore::sessions() const {
  return implementation_->read([&] {
    std::vector<SessionRow> rows;
    SQLite::Statement query(*implementation_->database,
                            "SELECT id, participant, kind, begun_at, ended_at, program_version, device, os, kernel, "
                            "cpu, loop_rate_hz, ticks, missed_ticks, safety_trips, protocol_sha256, simulation "
                            "FROM session ORDER BY id");
    while (query.executeStep()) {
      SessionRow row;
      row.id = query.getColumn(0).getInt64();
      row.participant = query.getColumn(1).getInt64();
      row.kind = query.getColumn(2).getString();
      row.begun_at = query.getColumn(3).getString();
      row.ended_at = query.getColumn(4).getString();
      row.program_version = query.getColumn(5).getString();
      row.device = query.getColumn(6).getString();
      row.machine = {.os = query.getColumn(7).getString(),
                     .kernel = query.getColumn(8).getString(),
                     .cpu = query.getColumn(9).getString()};
      if (const SQLite::Column rate = query.getColumn(10); !rate.isNull()) {
        row.loop_rate_hz = rate.getDouble();
      }
      if (const SQLite::Column ticks = query.getColumn(11); !ticks.isNull()) {
        row.counts = {.ticks = static_cast<std::uint64_t>(ticks.getInt64()),
                      .missed_ticks = static_cast<std::uint64_t>(query.getColumn(12).getInt64()),
                      .safety_trips = static_cast<std::uint64_t>(query.getColumn(13).getInt64())};
      }
      row.protocol_sha256 = query.getColumn(14).getString();
      row.simulation = query.getColumn(15).getString();
      rows.push_back(std::move(row));
    }
    return rows;
  });
}

void StudyStore::giveConsent(std::int64_t participant) {
  const StudyProtocol& protocol = implementation_->protocol;
  const std::string version =
      protocol.consent_version.empty() ? "sha256:" + sha256Of(protocol.consent) : protocol.consent_version;
  implementation_->write([&] {
    implementation_->requireParticipant(participant);
    return execute(*implementation_->database,
                   "INSERT INTO consent (participant, at, version, language, text) VALUES (?, ?, ?, ?, ?) "
                   "ON CONFLICT DO NOTHING",
                   participant, std::string_view(nowText()), std::string_view(version),
                   std::string_view(protocol.language), std::string_view(protocol.consent));
  });
}

std::vector<ConsentRow> StudyStore::consents() const {
  return implementation_->read([&] {
    std::vector<ConsentRow> rows;
    SQLite::Statement query(*implementation_->database,
                            "SELECT participant, at, version, language, text FROM consent ORDER BY participant");
    while (query.executeStep()) {
      rows.push_back({.participant = query.getColumn(0).getInt64(),
                      .at = query.getColumn(1).getString(),
                      .version = query.getColumn(2).getString(),
                      .language = query.getColumn(3).getString(),
                      .text = query.getColumn(4).getString()});
    }
    return rows;
  });
}

}  // namespace haptolith

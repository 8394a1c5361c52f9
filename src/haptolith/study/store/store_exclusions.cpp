// Exclusions from the analysis, with reasons: an append-only log.

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/study/store/store.h"
#include "haptolith/study/store/store_file.h"
#include "haptolith/study/store/store_implementation.h"
#include "haptolith/study/store/study_sql.h"

namespace haptolith {

void StudyStore::setExcluded(std::int64_t participant, bool excluded, std::string_view reason) {
  if (reason.find_first_not_of(" \t\n") == std::string_view::npos) {
    throw RefusedAction("reason", "the reason is missing: give a text");
  }
  implementation_->write([&] {
    implementation_->requireParticipant(participant);
    const std::vector<ParticipantRow> all = participants();
    const ParticipantRow& row = *std::ranges::find(all, participant, &ParticipantRow::id);
    if (row.excluded_for.empty() != excluded) {
      throw RefusedAction("participant", excluded ? fmt::format("participant '{}' is already excluded (reason: {})",
                                                                row.code, row.excluded_for)
                                                  : fmt::format("participant '{}' is not excluded", row.code));
    }
    return execute(*implementation_->database,
                   "INSERT INTO exclusion (participant, at, excluded, reason) VALUES (?, ?, ?, ?)", participant,
                   std::string_view(nowText()), excluded, reason);
  });
}

std::vector<ExclusionRow> StudyStore::exclusions() const {
  return implementation_->read([&] {
    std::vector<ExclusionRow> rows;
    SQLite::Statement query(*implementation_->database,
                            "SELECT participant, at, excluded, reason FROM exclusion ORDER BY id");
    while (query.executeStep()) {
      rows.push_back({.participant = query.getColumn(0).getInt64(),
                      .at = query.getColumn(1).getString(),
                      .excluded = query.getColumn(2).getInt() != 0,
                      .reason = query.getColumn(3).getString()});
    }
    return rows;
  });
}

}  // namespace haptolith

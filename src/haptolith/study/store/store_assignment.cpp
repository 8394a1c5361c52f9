// Assignment of participants to groups: each participant gets a place in the sequence of their stratum, which is never
// assigned again.

#include <SQLiteCpp/SQLiteCpp.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/protocol/form.h"
#include "haptolith/study/protocol/groups.h"
#include "haptolith/study/protocol/sequence.h"
#include "haptolith/study/store/store.h"
#include "haptolith/study/store/store_file.h"
#include "haptolith/study/store/store_implementation.h"
#include "haptolith/study/store/study_sql.h"

namespace haptolith {

namespace {

std::map<std::string, std::string> demographicsOf(SQLite::Database& database, std::int64_t participant) {
  std::map<std::string, std::string> answers;
  SQLite::Statement query = prepared(database, "SELECT key, value FROM form_answer WHERE participant = ? AND form = ?",
                                     participant, kDemographicsForm);
  while (query.executeStep()) {
    answers[query.getColumn(0).getString()] = query.getColumn(1).getString();
  }
  return answers;
}

/// Assigns and returns the next place of a stratum's sequence.
int takePlace(SQLite::Database& database, std::size_t stratum) {
  execute(database,
          "INSERT INTO allocation (stratum, places) VALUES (?, 1) "
          "ON CONFLICT (stratum) DO UPDATE SET places = places + 1",
          stratum);
  SQLite::Statement query = prepared(database, "SELECT places FROM allocation WHERE stratum = ?", stratum);
  query.executeStep();
  return query.getColumn(0).getInt() - 1;
}

}  // namespace

Assignment StudyStore::assignGroup(std::int64_t participant) {
  SQLite::Database& database = *implementation_->database;
  return implementation_->write([&] {
    implementation_->requireParticipant(participant);
    const std::vector<ParticipantRow> all = participants();
    if (const auto& own = std::ranges::find(all, participant, &ParticipantRow::id)->assignment) {
      return *own;
    }
    Assignment assignment;
    assignment.stratum = stratumOf(protocol(), demographicsOf(database, participant));
    assignment.place = takePlace(database, assignment.stratum);
    const ParticipantGroup& group =
        protocol().groups[groupAt(protocol(), seed(), assignment.stratum, static_cast<std::size_t>(assignment.place))];
    assignment.group = group.name;
    std::vector<int> rows;
    for (const ParticipantRow& other : all) {
      if (other.assignment && other.assignment->group == group.name && !isLeftOut(other)) {
        rows.push_back(other.assignment->row);
      }
    }
    assignment.row = nextRow(protocol(), group, rows);
    execute(database,
            "INSERT INTO assignment (participant, stratum, place, group_name, block_row, at) VALUES (?, ?, ?, ?, ?, ?)",
            participant, assignment.stratum, assignment.place, std::string_view(assignment.group), assignment.row,
            std::string_view(nowText()));
    return assignment;
  });
}

std::vector<int> StudyStore::placesGiven() const {
  return implementation_->read([&] {
    std::vector<int> places(strataOf(protocol()));
    SQLite::Statement query(*implementation_->database, "SELECT stratum, places FROM allocation");
    while (query.executeStep()) {
      if (const std::size_t stratum = query.getColumn(0).getUInt(); stratum < places.size()) {
        places[stratum] = query.getColumn(1).getInt();
      }
    }
    return places;
  });
}

}  // namespace haptolith

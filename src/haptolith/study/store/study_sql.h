#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "haptolith/core/plain_text.h"

namespace haptolith {

// SQL with values. All functions throw SQLite::Exception.

inline void bindAt(SQLite::Statement& query, int at, double value) {
  if (std::isnan(value)) {
    query.bind(at);
  } else {
    query.bind(at, value);
  }
}
inline void bindAt(SQLite::Statement& query, int at, std::string_view value) {
  query.bind(at, std::string(value));
}
inline void bindAt(SQLite::Statement& query, int at, std::int64_t value) {
  query.bind(at, value);
}
inline void bindAt(SQLite::Statement& query, int at, int value) {
  query.bind(at, value);
}
inline void bindAt(SQLite::Statement& query, int at, bool value) {
  query.bind(at, value ? 1 : 0);
}
inline void bindAt(SQLite::Statement& query, int at, std::size_t value) {
  query.bind(at, static_cast<std::int64_t>(value));
}
template <class Value>
void bindAt(SQLite::Statement& query, int at, const std::optional<Value>& value) {
  if (value) {
    bindAt(query, at, *value);
  } else {
    query.bind(at);
  }
}

/// Returns a statement with `values` bound to its question marks; NaN and nullopt become NULL.
template <class... Values>
[[nodiscard]] SQLite::Statement prepared(SQLite::Database& database, const std::string& sql, const Values&... values) {
  SQLite::Statement query(database, sql);
  int at = 0;
  (bindAt(query, ++at, values), ...);
  return query;
}

/// Executes a statement. @return number of changed rows.
template <class... Values>
int execute(SQLite::Database& database, const std::string& sql, const Values&... values) {
  return prepared(database, sql, values...).exec();
}

[[nodiscard]] inline double numberOrNan(const SQLite::Column& column) {
  return column.isNull() ? std::nan("") : column.getDouble();
}

/// Throws for a value that haptolith does not write: another program may have changed the file. tellWhatIsWrong() adds
/// the file's name, as for exceptions of SQLite.
[[noreturn]] inline void throwForeign(std::string_view column, std::string_view value, std::string_view valid) {
  throw SQLite::Exception(
      fmt::format("it holds what haptolith does not write: {} = {}; must be {}", column, inQuotes(value), valid));
}

}  // namespace haptolith

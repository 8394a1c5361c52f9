#include "haptolith/psychometrics/answers_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/files/table.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

constexpr std::array<std::string_view, 11> kColumns{"x",           "k",     "n",     "response", "value", "positive",
                                                    "participant", "group", "block", "kind",     "state"};
constexpr std::array<std::string_view, 3> kCodes{"participant", "group", "block"};

/// A study with a thousand participants has a few hundred thousand rows; questionnaire answers make some of them long.
constexpr TableFormat kFormat{
    .columns = kColumns, .limits = {.bytes = 256 << 20, .line_bytes = 100'000, .rows = 1'000'000}, .codes = kCodes};

/// Column of a study's export that marks the rows that count.
struct StandingColumn {
  std::string_view name;
  std::array<std::string_view, 4> words;  ///< values in an export
  std::array<bool, 4> counts;
};

constexpr std::array kStandingColumns{
    StandingColumn{"kind", {"practice", "main", "catch", ""}, {false, true, false, false}},
    StandingColumn{"state", {"begun", "answered", "repeated", "lost"}, {false, true, false, false}},
    StandingColumn{"participant_state", {"running", "finished", "withdrawn", "excluded"}, {true, true, false, false}}};

/// Returns the index of a cell's word among those of an export; empty for a word of the user.
std::optional<std::size_t> standingIn(const Table& table, Table::Column column, const StandingColumn& of) {
  std::string word = table.cell(column);
  std::ranges::transform(word, word.begin(), [](unsigned char letter) { return std::tolower(letter); });
  const auto found = std::ranges::find(of.words, word);
  return word.empty() || found == of.words.end() ? std::nullopt
                                                 : std::optional(static_cast<std::size_t>(found - of.words.begin()));
}

/// Columns that mark the rows that count: those with only the words of an export.
/// @throws InvalidParameter for a column with both these and other words.
class Standing {
 public:
  explicit Standing(Table& table) {
    struct Seen {
      Table::Column column;
      const StandingColumn* of;
      int known_line = 0;  ///< line of the first word of an export; 0: none so far
      std::optional<InvalidParameter> own;
    };
    std::vector<Seen> seen;
    for (const StandingColumn& of : kStandingColumns) {
      if (const std::optional<Table::Column> column = table.find(of.name)) {
        seen.push_back({*column, &of, 0, {}});
      }
    }
    while (!seen.empty() && table.next()) {
      for (Seen& one : seen) {
        if (standingIn(table, one.column, *one.of)) {
          one.known_line = one.known_line > 0 ? one.known_line : table.line();
        } else if (!one.own) {
          one.own.emplace(table.key(one.column), inQuotes(table.cell(one.column)), "");
        }
      }
    }
    for (const Seen& one : seen) {
      if (one.known_line > 0 && one.own) {
        throw InvalidParameter(
            one.own->key(), one.own->value(),
            fmt::format(
                "{}, as in line {} and in the export of a study; use another name for another column",
                fmt::join(one.of->words.begin(), one.of->words.end() - (one.of->words[3].empty() ? 1 : 0), ", "),
                one.known_line));
      }
      if (one.known_line > 0) {
        columns_.emplace_back(one.column, one.of);
      }
    }
  }

  [[nodiscard]] bool counts(const Table& table) const {
    return std::ranges::all_of(columns_, [&](const auto& column) {
      const std::optional<std::size_t> word = standingIn(table, column.first, *column.second);
      return word && column.second->counts.at(*word);
    });
  }

 private:
  std::vector<std::pair<Table::Column, const StandingColumn*>> columns_;
};

/// Returns the level of a row of x,k,n; empty if both k and n are missing.
std::optional<Level> countsOf(Table& table, Table::Column x, Table::Column k, Table::Column n) {
  if (table.isMissing(k) && (table.isMissing(n) || table.number(n) == 0)) {
    return std::nullopt;
  }
  const Level level{table.number(x), table.number(k), table.number(n)};
  if (level.n < 0 || level.n != std::floor(level.n)) {
    table.refuse(n, "a whole number of responses, 0 or more");
  }
  if (level.k < 0 || level.k > level.n || level.k != std::floor(level.k)) {
    table.refuse(k, fmt::format("a whole number of positive responses, 0 to n = {}", level.n));
  }
  return level;
}

/// Suspicious rows of one kind: their number, and the location of the first one.
struct OddRows {
  std::size_t count = 0;
  std::string first;

  void add(const std::string& place) { first = count++ == 0 ? place : first; }
  [[nodiscard]] std::string andMore() const { return count == 1 ? "" : fmt::format(" (and {} more rows)", count - 1); }
};

/// Collects warnings about the rows of a table.
class Oddities {
 public:
  /// @param all_differ  whether all rows should be different.
  explicit Oddities(bool all_differ) : all_differ_(all_differ) {}

  void add(const Table& table, std::optional<Table::Column> participant) {
    if (participant && table.isMissing(*participant)) {
      const std::string& code = table.cell(*participant);
      no_code_[code].add(table.key(*participant));
    }
    if (table.beginsWithHash()) {
      hash_.add(fmt::format("{} = {}", table.key(Table::Column{0}), inQuotes(table.cell(0))));
    }
    const std::size_t row = std::hash<std::string>()(fmt::format("{}", fmt::join(table.cells(), "\n")));
    rows_.push_back({row, table.line()});
  }

  [[nodiscard]] std::vector<std::string> text(std::string_view name, const std::vector<AnswersOf>& people) const {
    std::vector<std::string> warnings;
    for (const auto& [code, rows] : no_code_) {
      warnings.push_back(fmt::format("{} = {}{}: no code; these rows count as one participant", rows.first,
                                     inQuotes(code), rows.andMore()));
    }
    if (hash_.count > 0) {
      warnings.push_back(
          fmt::format("{}{}: read as a code; a comment begins with # and a space", hash_.first, hash_.andMore()));
    }
    if (const std::string shared = sharedCodes(people); !shared.empty()) {
      warnings.push_back(fmt::format("{}: {}: counted as different participants in each group", name, shared));
    }
    if (const std::string again = repeatedRows(); !again.empty()) {
      warnings.push_back(
          fmt::format("{}:{}; their responses count twice. Was a table appended to itself?", name, again));
    }
    return warnings;
  }

 private:
  struct Row {
    std::size_t hash;
    int line;
  };

  static std::string sharedCodes(const std::vector<AnswersOf>& people) {
    std::map<std::array<std::string, 2>, std::vector<std::string>> groups;  // groups by block and code
    for (const AnswersOf& of : people) {
      groups[{of.block, of.participant}].push_back(of.group);
    }
    std::erase_if(groups, [](const auto& of) { return of.first[1].empty() || of.second.size() < 2; });
    if (groups.empty()) {
      return "";
    }
    const auto& [first, its_groups] = *groups.begin();
    std::string names;
    for (const std::string& group : its_groups) {
      names += (names.empty() ? "" : ", ") + inQuotes(group);
    }
    return fmt::format("participant {} is in the groups {}{}", inQuotes(first[1]), shortened(names, 3 * kQuoteLetters),
                       groups.size() == 1 ? "" : fmt::format(" (and {} more in several)", groups.size() - 1));
  }

  [[nodiscard]] std::string repeatedRows() const {
    if (!all_differ_) {
      return repeatedTable();
    }
    std::unordered_map<std::size_t, int> first_lines;
    OddRows again;
    for (const Row& row : rows_) {
      const auto [first, is_new] = first_lines.try_emplace(row.hash, row.line);
      if (!is_new) {
        again.add(fmt::format("{}: the same row as in line {}", row.line, first->second));
      }
    }
    return again.count == 0 ? "" : again.first + again.andMore();
  }

  /// Detects a table that was appended to itself once or twice, which is improbable for independent responses.
  [[nodiscard]] std::string repeatedTable() const {
    constexpr std::size_t kFewest = 4;                 // fewer may be equal by chance
    std::vector<std::size_t> border(rows_.size(), 0);  // per prefix, its longest proper suffix that is a prefix
    for (std::size_t i = 1; i < rows_.size(); ++i) {
      std::size_t length = border[i - 1];
      while (length > 0 && rows_[i].hash != rows_[length].hash) {
        length = border[length - 1];
      }
      border[i] = length + (rows_[i].hash == rows_[length].hash ? 1 : 0);
    }
    const std::size_t period = rows_.size() - (rows_.empty() ? 0 : border.back());
    const bool again = period >= kFewest && (rows_.size() == 2 * period || rows_.size() == 3 * period);
    return again ? fmt::format("{}: the rows from here repeat the rows from line {}", rows_[period].line, rows_[0].line)
                 : "";
  }

  bool all_differ_;
  std::map<std::string, OddRows> no_code_;
  OddRows hash_;
  std::vector<Row> rows_;
};

/// Collects the levels of each block, participant and group.
class People {
 public:
  void add(AnswersOf&& of, const Level& level) {
    const auto [place, is_new] = places_.try_emplace({of.block, of.participant, of.group}, people_.size());
    if (is_new) {
      people_.push_back(std::move(of));
    }
    people_[place->second].levels.push_back(level);
  }

  [[nodiscard]] std::vector<AnswersOf> pooledLevels(double tolerance) && {
    for (AnswersOf& of : people_) {
      of.levels = tolerance > 0 ? pooledWithin(of.levels, tolerance) : pooled(of.levels);
    }
    std::erase_if(people_, [](const AnswersOf& of) { return of.levels.empty(); });
    return std::move(people_);
  }

 private:
  std::vector<AnswersOf> people_;
  std::map<std::array<std::string, 3>, std::size_t> places_;
};

std::string textIn(const Table& table, std::optional<Table::Column> column) {
  return column ? table.text(*column) : "";
}

}  // namespace

Answers readAnswers(std::istream& text, std::string_view name, double pool_tolerance) {
  requireInRange("pool tolerance", pool_tolerance, {.lowest = 0});
  const Standing standing = [&] {
    Table table(text, name, kFormat);
    return Standing(table);
  }();
  text.clear();
  text.seekg(0);
  Table table(text, name, kFormat);
  const auto either = [&](std::string_view one, std::string_view other) {
    const std::optional<Table::Column> found = table.find(one);
    return found ? found : table.find(other);
  };
  const auto x = either("x", "value"), response = either("response", "positive");
  const auto k = table.find("k"), n = table.find("n");
  const bool has_counts = k && n;
  if (!x || !(response || has_counts)) {
    table.refuseHeading("columns x,k,n, or x,response with a row for each trial");
  }
  const auto block = table.find("block"), participant = table.find("participant"), group = table.find("group");
  People people;
  Oddities oddities(has_counts || table.find("trial"));
  while (table.next()) {
    if (!standing.counts(table)) {
      continue;
    }
    std::optional<Level> level;
    if (has_counts) {
      level = countsOf(table, *x, *k, *n);
    } else if (const std::optional<bool> positive = table.flag(*response)) {
      level = {table.number(*x), *positive ? 1.0 : 0.0, 1};
    }
    if (level) {
      oddities.add(table, participant);
      people.add(
          {.block = textIn(table, block), .participant = textIn(table, participant), .group = textIn(table, group)},
          *level);
    }
  }
  Answers answers{.people = std::move(people).pooledLevels(pool_tolerance)};
  if (answers.people.empty()) {
    throw InvalidParameter(std::string(name), "without a response", "one or more responses");
  }
  answers.warnings = oddities.text(name, answers.people);
  return answers;
}

Answers readAnswersFile(const std::filesystem::path& path, double pool_tolerance) {
  std::ifstream file = openInput(path, kFormat.limits.bytes);
  return readAnswers(file, path.string(), pool_tolerance);
}

std::vector<std::string> namesOf(const std::vector<AnswersOf>& people) {
  std::map<std::string, int> counts;
  for (const AnswersOf& of : people) {
    ++counts[of.participant];
  }
  std::vector<std::string> names;
  names.reserve(people.size());
  for (const AnswersOf& of : people) {
    names.push_back(of.participant.empty()        ? fmt::format("{}", names.size() + 1)
                    : counts[of.participant] == 1 ? of.participant
                                                  : fmt::format("{} ({})", of.participant, of.group));
  }
  return names;
}

}  // namespace haptolith

#pragma once

#include <filesystem>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/psychometrics/levels.h"

namespace haptolith {

/// One person's answers in one block. A code in two groups is two people.
struct AnswersOf {
  std::string block = {};        ///< empty if the table has no such column
  std::string participant = {};  ///< the person's code; empty if the table has no such column
  std::string group = {};        ///< empty if the table has no such column
  std::vector<Level> levels = {};
};

/// The answers in a table, and what is odd about it.
struct Answers {
  std::vector<AnswersOf> people = {};      ///< of each block, in the order of the table
  std::vector<std::string> warnings = {};  ///< a sentence each, with the table's name
};

/// Reads answers from a table (core/files/table.h): a row for each level,
///
///     x,k,n            stimulus, positive answers, answers
///
/// or a row for each trial,
///
///     x,response       response: 1, yes, true, T or Y, or 0, no, false, F or N
///
/// where x may also be called `value` and response `positive`, as in a study's export. Columns `participant`, `group`
/// and `block` separate people and blocks. Rows whose response is missing (empty, NA, NaN) do not count, nor do those
/// that a study's export leaves out: `kind` practice or catch, `state` begun, repeated or lost, `participant_state`
/// withdrawn or excluded. Columns of these names with none of the export's words, and all others, are ignored. Levels
/// are pooled().
///
/// Warnings: codes in several groups, rows without a code, codes that begin with #, and rows that repeat others.
/// @param text  that can be read twice (seekg).
/// @param name  of the table, for messages.
/// @param pool_tolerance  stimuli that differ by no more are taken together, see pooledWithin().
/// @throws InvalidParameter with line and column for what cannot be understood, or when there is no answer.
[[nodiscard]] Answers readAnswers(std::istream& text, std::string_view name, double pool_tolerance = 0);

/// Reads answers from a file of at most a million rows, 256 MiB, and lines of 100 000 bytes.
/// @throws as readAnswers(); InvalidParameter when there is none; Failure when it cannot be read, or stopAsked().
[[nodiscard]] Answers readAnswersFile(const std::filesystem::path& path, double pool_tolerance = 0);

/// A name for each: the person's code, with the group where others have the same code, or a number without a code.
[[nodiscard]] std::vector<std::string> namesOf(const std::vector<AnswersOf>& people);

}  // namespace haptolith

#pragma once

#include <filesystem>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/psychometrics/levels.h"

namespace haptolith {

/// Responses of one participant in one block. A code in two groups counts as two participants.
struct AnswersOf {
  std::string block = {};        ///< empty if the table has no such column
  std::string participant = {};  ///< the person's code; empty if the table has no such column
  std::string group = {};        ///< empty if the table has no such column
  std::vector<Level> levels = {};
};

/// Responses in a table, with warnings.
struct Answers {
  std::vector<AnswersOf> people = {};      ///< participants of each block, in the order of the table
  std::vector<std::string> warnings = {};  ///< one sentence each, with the table's name
};

/// Reads responses from a table (core/files/table.h): one row per level,
///
///     x,k,n            stimulus, positive responses, responses
///
/// or one row per trial,
///
///     x,response       response: 1, yes, true, T or Y, or 0, no, false, F or N
///
/// The names `value` for x and `positive` for response are also valid, as in a study's export. Columns `participant`,
/// `group` and `block` separate participants and blocks. Rows with a missing response (empty, NA, NaN) do not count.
/// Rows excluded by a study's export do not count either: `kind` practice or catch, `state` begun, repeated or lost,
/// `participant_state` withdrawn or excluded. Columns of these names without the export's words, and all other columns,
/// are ignored. Levels are pooled().
///
/// Warnings: codes in several groups, rows without a code, codes that begin with #, and repeated rows.
/// @param text  stream that can be read twice (seekg).
/// @param name  name of the table, for messages.
/// @param pool_tolerance  max. difference of pooled stimuli, see pooledWithin().
/// @throws InvalidParameter with line and column for invalid content, or if there are no responses.
[[nodiscard]] Answers readAnswers(std::istream& text, std::string_view name, double pool_tolerance = 0);

/// Reads responses from a file of at most a million rows, 256 MiB, and lines of 100 000 bytes.
/// @throws as readAnswers(); InvalidParameter if the file does not exist; Failure if it cannot be read, or stopAsked().
[[nodiscard]] Answers readAnswersFile(const std::filesystem::path& path, double pool_tolerance = 0);

/// Returns a name for each: the participant's code, with the group if the code is not unique; a number without a code.
[[nodiscard]] std::vector<std::string> namesOf(const std::vector<AnswersOf>& people);

}  // namespace haptolith

#pragma once

#include <filesystem>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/psychometrics/levels.h"

namespace haptolith {

/// One person's answers in one block.
struct AnswersOf {
  std::string block = {};        ///< empty where the file has no such column
  std::string participant = {};  ///< the same
  std::string group = {};        ///< the same; of the participant's first row
  std::vector<Level> levels = {};
};

/// Reads answers from a table with a line of column names: a row for each level,
///
///     x,k,n            stimulus, positive answers, answers
///
/// or a row for each trial,
///
///     x,response       response: 1, yes, true, or 0, no, false
///
/// where x may also be called `value` and response `positive`, as in a study's export. Columns `participant` and
/// `block` part the rows, `group` parts participants; rows whose `kind` is not "main", whose `state` is not "answered"
/// or whose response is empty or "n/a" do not count; other columns are ignored. Commas, semicolons or tabs part the
/// cells, quotes may surround them, and lines that begin with # are comments. The order is that of the first
/// appearance; levels are pooled().
/// @param name  of the table, for messages.
/// @param pool_tolerance  stimuli that differ by no more are taken together, see pooledWithin().
/// @throws InvalidParameter with line and column for what cannot be understood, or when there is no answer.
[[nodiscard]] std::vector<AnswersOf> readAnswers(std::istream& text, std::string_view name, double pool_tolerance = 0);

/// The same from a file: at most a million rows, 256 MiB, and lines of 100 000 bytes.
/// @throws InvalidParameter when there is none; Failure when it cannot be read, or the work is stopped.
[[nodiscard]] std::vector<AnswersOf> readAnswersFile(const std::filesystem::path& path, double pool_tolerance = 0);

}  // namespace haptolith

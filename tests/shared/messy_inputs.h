#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace haptolith {

/// The expected result of reading an input: a line of tests/data/messy/FOLDER/expectations.txt, one of
///
///     INPUT is CLEAN              reading INPUT gives what reading CLEAN gives
///     INPUT warned LINE WORDS     INPUT is read with a warning that names this line (0: none) and has these words
///     INPUT refused LINE WORDS    INPUT is refused, as InvalidParameter, with this line and these words
///
/// with names relative to the folder and without spaces. Empty lines and those that begin with # are comments.
struct Expectation {
  std::string input, verb;
  std::string clean;  ///< for "is"
  int line = 0;       ///< for "warned" and "refused"
  std::string words = {};
};

/// All of `folder`/expectations.txt, in order. Expects that every file of the folder is named in it.
[[nodiscard]] std::vector<Expectation> expectationsIn(const std::filesystem::path& folder);

/// Expects that the message has the line and the words.
void expectWords(const std::string& message, const Expectation& expected);

/// Calls `read` and expects what is written: `read` compares with the clean input, or returns what it warned of.
void expectAsWritten(const Expectation& expected, const std::function<std::string()>& read);

/// Result of a reader: all of it as text, equal for equal inputs, and its warnings.
struct Reading {
  std::string text, warnings = {};
};

/// Reads every input of `folder` and expects what is written for it.
/// @param readers  by the first folder of an input's name.
/// @param fewest  inputs for each reader.
void expectAsWritten(const std::filesystem::path& folder,
                     const std::map<std::string, std::function<Reading(const std::filesystem::path&)>>& readers,
                     int fewest);

}  // namespace haptolith

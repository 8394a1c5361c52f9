#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace haptolith {

/// What a reader made of an input: all of it as text, in which equal inputs are equal, and what it warned of.
struct Reading {
  std::string text, warnings = {};
};

/// Reads every input that `folder`/expectations.txt names, and expects what is written there. A line is one of
///
///     INPUT is CLEAN              reading INPUT gives the text that reading CLEAN gives
///     INPUT warned LINE WORDS     INPUT is read with a warning that names this line (0: none) and has these words
///     INPUT refused LINE WORDS    INPUT is refused, as InvalidParameter, with this line and these words
///
/// with names relative to `folder` and without spaces; empty lines and those that begin with # are comments. Every file
/// of the folder has to be named.
/// @param readers  by the first folder of an INPUT's name.
/// @param fewest  inputs for each reader.
void expectAsWritten(const std::filesystem::path& folder,
                     const std::map<std::string, std::function<Reading(const std::filesystem::path&)>>& readers,
                     int fewest);

}  // namespace haptolith

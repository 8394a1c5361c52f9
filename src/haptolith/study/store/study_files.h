#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace haptolith {

// The files beside a study: the recordings of its trials, and what others have made of it.

/// Where the recordings of a study's trials go: the folder "friction-recordings" beside friction.study.
[[nodiscard]] std::filesystem::path recordingsFolder(const std::filesystem::path& study);

/// The recordings of one participant, also those that were cut off while they were made; by name. They are those of the
/// trials, and what else there begins with the code, unless another study has its recordings in the same folder: then
/// that may be somebody else's.
/// @param trials  the names that the study knows their recordings by (TrialRow::recording).
/// @throws Failure when the folder cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> recordingsOf(const std::filesystem::path& study, std::string_view code,
                                                              std::span<const std::string> trials);

/// Deletes files, and sees to it that they stay deleted after a power cut. One that is not there is no error.
/// @throws Failure for the first that cannot be deleted.
void deleteFiles(const std::vector<std::filesystem::path>& files);

/// What else beside the study names a participant: files with the code in their text (an exported table), folders with
/// a folder of that participant (an exported BIDS folder), and recordings whose names begin with the code. Neither
/// studies nor recordings nor files above 64 MiB are looked into. What cannot be read is left out.
[[nodiscard]] std::vector<std::filesystem::path> othersThatName(const std::filesystem::path& study,
                                                                std::string_view code);

}  // namespace haptolith

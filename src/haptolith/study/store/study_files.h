#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace haptolith {

// The files beside a study: the recordings of its trials, and what others have made of it.

/// Where the recordings of a study's trials go: the folder "friction-recordings" beside friction.study.
[[nodiscard]] std::filesystem::path recordingsFolder(const std::filesystem::path& study);

/// The recordings of one participant, also those that were cut off while they were made; by name.
/// @throws Failure when the folder cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> recordingsOf(const std::filesystem::path& study,
                                                              std::string_view code);

/// Deletes files, and sees to it that they stay deleted after a power cut. One that is not there is no error.
/// @throws Failure for the first that cannot be deleted.
void deleteFiles(const std::vector<std::filesystem::path>& files);

/// What else beside the study names a participant: files with the code in their text (an exported table), and folders
/// with a folder of that participant (an exported BIDS folder). Neither studies nor recordings nor files above 64 MiB
/// are looked into. What cannot be read is left out.
[[nodiscard]] std::vector<std::filesystem::path> othersThatName(const std::filesystem::path& study,
                                                                std::string_view code);

}  // namespace haptolith

#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace haptolith {

// Files next to a study: recordings of its trials, and files derived from it.

/// Returns the folder for the recordings of a study's trials: "friction-recordings" next to friction.study.
[[nodiscard]] std::filesystem::path recordingsFolder(const std::filesystem::path& study);

/// Returns the recordings of one participant, including interrupted ones, sorted by name: those of the trials, and
/// other recordings in the folder whose names begin with the code. The latter are left out if another study uses the
/// folder, because they may belong to another participant.
/// @param trials  names of the recordings in the study (TrialRow::recording).
/// @throws Failure if the folder cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> recordingsOf(const std::filesystem::path& study, std::string_view code,
                                                              std::span<const std::string> trials);

/// Deletes files, durably even after a power cut. A missing file is not an error.
/// @throws Failure for the first that cannot be deleted.
void deleteFiles(const std::vector<std::filesystem::path>& files);

/// Returns other files next to the study that name a participant. They are files with the code in their text (an
/// exported table), folders with a folder of this participant (an exported BIDS folder), and recordings whose names
/// begin with the code. Contents of studies, recordings and files above 64 MiB are not searched. Unreadable files are
/// left out.
[[nodiscard]] std::vector<std::filesystem::path> othersThatName(const std::filesystem::path& study,
                                                                std::string_view code);

}  // namespace haptolith

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "haptolith/identify/training/training.h"

namespace haptolith {

/// Returns a training as JSON text with the keys in docs/how-to/identify-a-soil.md; forces have four digits.
[[nodiscard]] std::string trainingText(const Training& training);

/// Parses a training. @param name  name of the text, for messages. @throws InvalidParameter if it is not a training.
[[nodiscard]] Training parseTraining(std::string_view text, std::string_view name);

/// @throws as openInput() and parseTraining().
[[nodiscard]] Training readTraining(const std::filesystem::path& path);

/// Returns the built-in training of the probe with the icra2021 shovel on the Moon. @throws Failure if it is damaged.
[[nodiscard]] const Training& probeTraining();

}  // namespace haptolith

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "haptolith/identify/training/training.h"

namespace haptolith {

/// A training as JSON text; forces with four digits. Keys: docs/how-to/identify-a-soil.md.
[[nodiscard]] std::string trainingText(const Training& training);

/// The other way round. @param name  of the text, for messages. @throws InvalidParameter for what is no training.
[[nodiscard]] Training parseTraining(std::string_view text, std::string_view name);

/// @throws as openInput() and parseTraining().
[[nodiscard]] Training readTraining(const std::filesystem::path& path);

/// That of the probe with the paper's shovel on the Moon, which is built in. @throws Failure when it is damaged.
[[nodiscard]] const Training& probeTraining();

}  // namespace haptolith

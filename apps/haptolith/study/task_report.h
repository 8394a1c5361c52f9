#pragma once

#include <nlohmann/json.hpp>

#include <string>

#include "haptolith/study/perception/task_perception.h"

namespace haptolith {

/// Returns a table of the information in force alone and in the visual cue alone for a study's block.
[[nodiscard]] std::string taskTable(const std::string& protocol, const TaskPerception& task,
                                    const TaskOptions& options);

/// Returns the table as JSON, with the cues' means.
[[nodiscard]] nlohmann::ordered_json taskJson(const std::string& protocol, const TaskPerception& task,
                                              const TaskOptions& options);

}  // namespace haptolith

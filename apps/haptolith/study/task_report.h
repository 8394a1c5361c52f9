#pragma once

#include <nlohmann/json.hpp>

#include <string>

#include "haptolith/study/perception/task_perception.h"

namespace haptolith {

/// How much force alone and the picture alone tell of a study's block, as a table.
[[nodiscard]] std::string taskTable(const std::string& protocol, const TaskPerception& task,
                                    const TaskOptions& options);

/// The same, with the cues' means.
[[nodiscard]] nlohmann::ordered_json taskJson(const std::string& protocol, const TaskPerception& task,
                                              const TaskOptions& options);

}  // namespace haptolith

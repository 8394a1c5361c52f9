#pragma once

#include <haptolith/haptolith.h>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "haptolith/c_api/handles.h"

namespace haptolith::library {

/// A result with more than one number: a JSON object, and a table of numbers.
struct Result {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  std::vector<std::string> names = {};  ///< names of the columns
  std::vector<std::vector<double>> columns = {};
  std::string text = {};  ///< text of the JSON, made by handOut()
};

/// A handle to it, with the columns' names in the JSON.
[[nodiscard]] hapto_result* handleOf(Result result);

}  // namespace haptolith::library

struct hapto_result : haptolith::library::HandleOf<haptolith::library::Result> {
  static constexpr std::uint32_t kKind = 0x48615265;
};

#include "haptolith/c_api/result.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/values.h"
#include "haptolith/lab/catalogue/lab_test.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/presets.h"

namespace haptolith::library {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kWhatThereIs = "scenes, soils, presets, bodies, lab tests or instruction set";

std::vector<std::string> namesOfKind(std::string_view what) {
  std::vector<std::string> names;
  if (what == "scenes") {
    return sceneNames();
  }
  if (what == "soils") {
    return soilNames();
  }
  if (what == "presets") {
    for (const Preset& preset : presets()) {
      names.emplace_back(preset.name);
    }
    return names;
  }
  if (what == "bodies") {
    for (const Body& body : bodies()) {
      names.emplace_back(body.name);
    }
    return names;
  }
  if (what == "lab tests") {
    for (const LabTest& test : labTests()) {
      names.push_back(test.name);
    }
    return names;
  }
  if (what == "instruction set") {
    return {simdTarget()};
  }
  throw InvalidParameter("what", fmt::format("'{}'", what), kWhatThereIs);
}

/// "points.0.peak_pa": null when there is nothing.
const Json* find(const Json& json, std::string_view path) {
  const Json* at = &json;
  while (at != nullptr && !path.empty()) {
    const std::size_t dot = path.find('.');
    const std::string_view part = path.substr(0, dot);
    path = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
    if (at->is_array()) {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
      const bool is_index = error == std::errc() && end == part.data() + part.size() && index < at->size();
      at = is_index ? &(*at)[index] : nullptr;
    } else {
      const auto member = at->is_object() ? at->find(std::string(part)) : at->end();
      at = member == at->end() ? nullptr : &*member;
    }
  }
  return at;
}

}  // namespace

hapto_result* handleOf(Result result) {
  if (!result.names.empty()) {
    result.json["columns"] = result.names;
  }
  result.text = result.json.dump();
  return Places<hapto_result>::take(std::make_unique<Result>(std::move(result)));
}

}  // namespace haptolith::library

using namespace haptolith;
using namespace haptolith::library;

std::int32_t hapto_result_json(const hapto_result* result, const char** json) {
  const Claim claim(result);
  if (claim.status() != HAPTO_OK || json == nullptr) {
    return wrongArgument(claim.status() != HAPTO_OK ? claim.status() : HAPTO_NULL,
                         claim.status() != HAPTO_OK ? "result" : "json");
  }
  *json = claim->text.c_str();
  return HAPTO_OK;
}

std::int32_t hapto_result_value(const hapto_result* result, const char* path, double* out) {
  const Claim claim(result);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), "result");
  }
  if (path == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, path == nullptr ? "path" : "out");
  }
  return guarded([&] {
    const Json* found = find(claim->json, path);
    if (found == nullptr || !found->is_number()) {
      return failed(HAPTO_INVALID_PARAMETER,
                    fmt::format("path = {} is not valid: must be that of a number of the result", path), "path", path,
                    "that of a number of the result");
    }
    *out = found->get<double>();
    return std::int32_t{HAPTO_OK};
  });
}

std::int32_t hapto_result_column(const hapto_result* result, const char* name, hapto_array* out) {
  const Claim claim(result);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), "result");
  }
  if (const std::int32_t status = sizeStatus(out); status != HAPTO_OK || name == nullptr) {
    return wrongArgument(status != HAPTO_OK ? status : HAPTO_NULL, status != HAPTO_OK ? "out" : "name");
  }
  return guarded([&] {
    const auto found = std::ranges::find(claim->names, std::string_view(name));
    if (found == claim->names.end()) {
      throw InvalidParameter(
          "name", fmt::format("'{}'", name),
          claim->names.empty() ? "none: this result has no table" : anyOf({claim->names.begin(), claim->names.end()}));
    }
    const std::vector<double>& column = claim->columns[static_cast<std::size_t>(found - claim->names.begin())];
    give({.size = 0,
          .type = HAPTO_FLOAT64,
          .count = column.size(),
          .components = 1,
          .stride_bytes = sizeof(double),
          .data = column.data()},
         *out);
    return std::int32_t{HAPTO_OK};
  });
}

std::int32_t hapto_result_destroy(hapto_result* result) {
  Claim claim(result);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), "result");
  }
  claim.destroy();
  return HAPTO_OK;
}

std::int32_t hapto_list(const char* what, hapto_result** out) {
  if (what == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, what == nullptr ? "what" : "out");
  }
  return guarded([&] {
    readEnvironment();
    Result result;
    result.json["names"] = namesOfKind(what);
    *out = handleOf(std::move(result));
    return std::int32_t{HAPTO_OK};
  });
}

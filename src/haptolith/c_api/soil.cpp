// Soils with names.

#include <fmt/format.h>
#include <haptolith/haptolith.h>

#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/result.h"
#include "haptolith/c_api/soil_object.h"
#include "haptolith/c_api/values.h"
#include "haptolith/scene_file/soil_file_keys.h"
#include "haptolith/soil/layers.h"

using namespace haptolith;
using namespace haptolith::library;

namespace {

/// The number of a dotted key; NaN if it is absent.
template <class Target>
std::optional<double> numberAt(std::string_view dotted, std::span<const FileKey<Target>> keys, const Target& target) {
  for (const FileKey<Target>& key : keys) {
    const auto* number = std::get_if<typename FileKey<Target>::NumberValue>(&key.value);
    if (number != nullptr && number->get != nullptr && dotted == fmt::format("{}.{}", key.table, key.name)) {
      const double value = number->get(target);
      return std::isnan(value) ? std::nullopt : std::optional(value);
    }
  }
  return std::nullopt;
}

std::optional<double> numberAt(const NamedSoil& soil, std::string_view key) {
  SceneFile scene;
  scene.bed.soil = soil.soil;
  if (const auto number = numberAt(key, soilKeys(), scene)) {
    return number;
  }
  return soil.file ? numberAt(key, soilFileKeys(), *soil.file) : std::nullopt;
}

std::int32_t handOut(NamedSoil soil, hapto_soil** out) {
  *out = Places<hapto_soil>::take(std::make_unique<NamedSoil>(std::move(soil)));
  return HAPTO_OK;
}

template <class Body>
std::int32_t with(const hapto_soil* soil, const void* argument, const char* its_name, Body&& body) {
  const Claim claim(soil);
  if (claim.status() != HAPTO_OK || argument == nullptr) {
    return wrongArgument(claim.status() != HAPTO_OK ? claim.status() : HAPTO_NULL,
                         claim.status() != HAPTO_OK ? "soil" : its_name);
  }
  return guarded([&] { return body(*claim); });
}

}  // namespace

std::int32_t hapto_soil_find(const char* name_or_path, hapto_soil** out) {
  if (name_or_path == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, name_or_path == nullptr ? "name_or_path" : "out");
  }
  return guarded([&] { return handOut(findSoilOrPreset(name_or_path), out); });
}

std::int32_t hapto_soil_from_toml(const char* text, const char* name, hapto_soil** out) {
  if (text == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, text == nullptr ? "text" : "out");
  }
  return guarded([&] {
    SoilFile file = soilFileFromText(text, name == nullptr ? "soil" : name);
    return handOut({file.name, file.soil, std::move(file)}, out);
  });
}

std::int32_t hapto_soil_destroy(hapto_soil* soil) {
  Claim claim(soil);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), "soil");
  }
  claim.destroy();
  return HAPTO_OK;
}

std::int32_t hapto_soil_get(const hapto_soil* soil, const char* key, double* out) {
  if (key == nullptr) {
    return wrongArgument(HAPTO_NULL, "key");
  }
  return with(soil, out, "out", [&](const NamedSoil& object) {
    const auto number = numberAt(object, key);
    if (!number) {
      throw InvalidParameter("key", fmt::format("'{}'", key),
                             "a number of this soil's file, for example soil.radius_mm (docs/reference/soils.md)");
    }
    *out = *number;
    return HAPTO_OK;
  });
}

std::int32_t hapto_soil_get_toml(const hapto_soil* soil, char* text, std::uint64_t capacity, std::uint64_t* needed) {
  return with(soil, soil, "soil", [&](const NamedSoil& object) -> std::int32_t {
    if (!object.file) {
      throw InvalidParameter("soil", object.name, "a soil with measured properties, not a preset");
    }
    const std::string toml = soilFileText(*object.file);
    return handOut({toml.c_str(), toml.size() + 1}, text, capacity, needed);
  });
}

std::int32_t hapto_soil_profile(const hapto_soil* soil, double gravity_m_s2, double depth_m, hapto_result** out) {
  return with(soil, out, "out", [&](const NamedSoil& object) {
    constexpr Range kGravity_m_s2{0, 1000};
    requireInRange("gravity_m_s2", gravity_m_s2, kGravity_m_s2);
    const std::vector<Layer> layers = layersToDepth(object.soil, gravity_m_s2, depth_m);
    Result result;
    result.json["soil"] = object.name;
    result.json["gravity_m_s2"] = gravity_m_s2;
    const auto add = [&](const char* name, double Layer::*number) {
      result.names.emplace_back(name);
      std::vector<double>& column = result.columns.emplace_back();
      for (const Layer& layer : layers) {
        column.push_back(layer.*number);
      }
    };
    add("depth_m", &Layer::depth_m);
    add("top_m", &Layer::top_m);
    add("bottom_m", &Layer::bottom_m);
    add("spacing_m", &Layer::spacing_m);
    add("density_kg_m3", &Layer::density_kg_m3);
    *out = handleOf(std::move(result));
    return HAPTO_OK;
  });
}

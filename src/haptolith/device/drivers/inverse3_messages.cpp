#include "haptolith/device/drivers/inverse3_messages.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>

namespace haptolith {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestId = 64;
constexpr double kFurthest_m = 2;
constexpr double kFastest_m_s = 50;

/// The member of an object; none of anything else.
const Json* find(const Json& object, const char* key) {
  if (!object.is_object()) {
    return nullptr;
  }
  const auto at = object.find(key);
  return at == object.end() ? nullptr : &*at;
}

const Json* find(const Json* object, const char* key) {
  return object == nullptr ? nullptr : find(*object, key);
}

std::string_view idOf(const Json& entry) {
  const Json* id = find(entry, "device_id");
  const auto* text = id == nullptr ? nullptr : id->get_ptr<const std::string*>();
  return text == nullptr || text->size() > kLongestId ? std::string_view{} : std::string_view(*text);
}

/// The entries of a list that have an id.
std::vector<const Json*> entries(const Json& message, const char* list) {
  std::vector<const Json*> found;
  const Json* all = find(message, list);
  if (all != nullptr && all->is_array()) {
    for (const Json& entry : *all) {
      if (!idOf(entry).empty()) {
        found.push_back(&entry);
      }
    }
  }
  return found;
}

const Json* stateOf(const Json& message, const char* list, std::string_view id) {
  for (const Json* entry : entries(message, list)) {
    if (idOf(*entry) == id) {
      return find(entry, "state");
    }
  }
  return nullptr;
}

/// The numbers under these keys; none unless all are numbers, finite and of at most this size.
template <std::size_t kCount>
std::optional<std::array<double, kCount>> numbers(const Json* object, const std::array<const char*, kCount>& keys,
                                                  double largest) {
  std::array<double, kCount> values{};
  for (std::size_t i = 0; i < kCount; ++i) {
    const Json* number = find(object, keys[i]);
    if (number == nullptr || !number->is_number()) {
      return std::nullopt;
    }
    values[i] = number->get<double>();
    if (!(std::abs(values[i]) <= largest)) {  // also when it is NaN
      return std::nullopt;
    }
  }
  return values;
}

std::optional<Vec3> vector(const Json* object, double largest) {
  const auto v = numbers<3>(object, {"x", "y", "z"}, largest);
  return v ? std::optional(Vec3((*v)[0], (*v)[1], (*v)[2])) : std::nullopt;
}

std::optional<Quat> unitQuaternion(const Json* object) {
  const auto q = numbers<4>(object, {"w", "x", "y", "z"}, 2);
  if (!q) {
    return std::nullopt;
  }
  const Quat turn((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
  return isUnit(turn) ? std::optional(turn.normalized()) : std::nullopt;
}

std::optional<std::uint32_t> buttonsOf(const Json* object) {
  if (object == nullptr || !object->is_object()) {
    return std::nullopt;
  }
  std::uint32_t buttons = 0;
  std::uint32_t bit = 1;
  for (const char* name : {"a", "b", "c"}) {
    const Json* down = find(object, name);
    buttons |= down != nullptr && down->is_boolean() && down->get<bool>() ? bit : 0;
    bit <<= 1;
  }
  return buttons;
}

Json parsed(std::string_view json) {
  return Json::parse(json, nullptr, false);
}

bool isSince35(const Json& message) {
  if (find(message, "session_id") != nullptr) {
    return true;
  }
  for (const Json* entry : entries(message, "inverse3")) {
    const Json* config = find(entry, "config");
    for (const char* news : {"basis", "mount", "preset", "filters"}) {
      if (find(config, news) != nullptr) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

std::optional<HaplyInventory> parseHaplyInventory(std::string_view json) {
  const Json message = parsed(json);
  if (!message.is_object()) {
    return std::nullopt;
  }
  HaplyInventory inventory;
  for (const Json* entry : entries(message, "inverse3")) {
    inventory.devices.emplace_back(idOf(*entry));
  }
  for (const Json* entry : entries(message, "wireless_verse_grip")) {
    inventory.grips.emplace_back(idOf(*entry));
  }
  inventory.dialect = isSince35(message) ? HaplyDialect::kVector : HaplyDialect::kValues;
  return inventory;
}

std::optional<Inverse3State> parseInverse3State(std::string_view json, std::string_view device, std::string_view grip) {
  const Json message = parsed(json);
  const Json* arm = stateOf(message, "inverse3", device);
  const std::optional<Vec3> position_m = vector(find(arm, "cursor_position"), kFurthest_m);
  const std::optional<Vec3> velocity_m_s = vector(find(arm, "cursor_velocity"), kFastest_m_s);
  if (!position_m || !velocity_m_s) {
    return std::nullopt;
  }
  Inverse3State state;
  state.position_m = *position_m;
  state.velocity_m_s = *velocity_m_s;
  if (!grip.empty()) {
    const Json* held = stateOf(message, "wireless_verse_grip", grip);
    state.orientation = unitQuaternion(find(held, "orientation"));
    state.buttons = buttonsOf(find(held, "buttons"));
  }
  return state;
}

std::string inverse3Command(std::string_view device, const Vec3& force_n, HaplyDialect dialect) {
  Json force;
  force[dialect == HaplyDialect::kVector ? "vector" : "values"] = {
      {"x", force_n.x()}, {"y", force_n.y()}, {"z", force_n.z()}};
  Json entry;
  entry["device_id"] = device;
  entry["commands"]["set_cursor_force"] = std::move(force);
  Json message;
  message["inverse3"] = Json::array({std::move(entry)});
  return message.dump();
}

}  // namespace haptolith

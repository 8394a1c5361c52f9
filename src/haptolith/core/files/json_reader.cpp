#include "haptolith/core/files/json_reader.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "haptolith/core/plain_text.h"

namespace haptolith {

bool JsonValue::has(std::string_view key) const {
  return json_->is_object() && json_->contains(key);
}

JsonValue JsonValue::at(std::string_view key) const {
  std::optional<JsonValue> found = find(key);
  if (!found) {
    throw RefusedAction(pathOf(key), fmt::format("{} is missing", pathOf(key)));
  }
  return *std::move(found);
}

std::optional<JsonValue> JsonValue::find(std::string_view key) const {
  require(json_->is_object(), "an object");
  const auto found = json_->find(key);
  if (found == json_->end()) {
    return std::nullopt;
  }
  read_.push_back(&*found);
  return JsonValue({json_, &*found}, pathOf(key));
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::members() const {
  require(json_->is_object(), "an object");
  std::vector<std::pair<std::string, JsonValue>> members;
  for (const auto& [key, value] : json_->items()) {
    members.emplace_back(key, at(key));
  }
  return members;
}

void JsonValue::refuseOtherKeys() const {
  for (const auto& [key, value] : json_->items()) {
    if (std::ranges::find(read_, &value) == read_.end()) {
      throw RefusedAction(pathOf(key), fmt::format("{} is not known: remove this key", pathOf(key)));
    }
  }
}

std::size_t JsonValue::size() const noexcept {
  return json_->is_array() ? json_->size() : 0;
}

JsonValue JsonValue::at(std::size_t index) const {
  requireList(0, kAnySize);
  if (index >= size()) {
    refuse(fmt::format("without {}", index), fmt::format("a list of more than {} values", index));
  }
  return {{json_, &(*json_)[index]}, fmt::format("{}[{}]", path_, index)};
}

std::vector<JsonValue> JsonValue::list(std::size_t min_size, std::size_t max_size) const {
  requireList(min_size, max_size);
  std::vector<JsonValue> values;
  values.reserve(size());
  for (std::size_t i = 0; i < size(); ++i) {
    values.push_back(at(i));
  }
  return values;
}

double JsonValue::number(const Range& valid) const {
  require(json_->is_number(), "a number");
  return requireInRange(path_, json_->get<double>(), valid);
}

std::uint64_t JsonValue::whole(std::uint64_t max) const {
  const bool is_whole = json_->is_number_unsigned() || (json_->is_number_integer() && json_->get<std::int64_t>() >= 0);
  if (!is_whole || json_->get<std::uint64_t>() > max) {
    refuse(given(), fmt::format("a whole number from 0 to {}", max));
  }
  return json_->get<std::uint64_t>();
}

const std::string& JsonValue::text() const {
  require(json_->is_string(), "a text");
  return json_->get_ref<const std::string&>();
}

bool JsonValue::flag() const {
  require(json_->is_boolean(), "true or false");
  return json_->get<bool>();
}

std::string JsonValue::given() const {
  return json_->is_string()   ? inQuotes(json_->get_ref<const std::string&>())
         : json_->is_array()  ? fmt::format("a list of {}", json_->size())
         : json_->is_object() ? "an object"
                              : json_->dump();
}

void JsonValue::refuse(const std::string& given, const std::string& valid) const {
  throw InvalidParameter(path_.empty() ? "message" : path_, given, valid);
}

void JsonValue::require(bool has_type, const char* type) const {
  if (!has_type) {
    refuse(given(), type);
  }
}

void JsonValue::requireList(std::size_t min_size, std::size_t max_size) const {
  if (!json_->is_array() || size() < min_size || size() > max_size) {
    refuse(given(), max_size == kAnySize   ? "a list"
                    : min_size == max_size ? fmt::format("a list of {}", min_size)
                                           : fmt::format("a list of {} to {}", min_size, max_size));
  }
}

std::string JsonValue::pathOf(std::string_view key) const {
  return path_.empty() ? shortened(key) : fmt::format("{}{}{}", path_, is_root_ ? ": " : ".", shortened(key));
}

JsonValue parseJson(std::string_view text, const std::string& name, const std::string& kind, const JsonLimits& limits) {
  using Json = nlohmann::json;
  using Event = Json::parse_event_t;
  const auto refuse = [&](const std::string& given, const std::string& valid) {
    JsonValue(nullptr, name).refuse(given, valid);
  };
  std::size_t values = 0;
  const auto within_limits = [&](int depth, Event event, const Json& /*parsed*/) {
    values += event != Event::array_end && event != Event::object_end ? 1 : 0;
    if ((event == Event::object_start || event == Event::array_start) && depth >= limits.depth) {
      refuse(fmt::format("nested more than {} deep", limits.depth),
             fmt::format("{}, at most {} brackets deep", kind, limits.depth));
    }
    if (values > limits.values) {
      refuse("too many values", fmt::format("{}, at most {} values", kind, limits.values));
    }
    return true;
  };
  JsonValue root(nullptr, name, true);
  try {
    root = JsonValue(std::make_shared<const Json>(Json::parse(text, within_limits)), name, true);
  } catch (const Json::parse_error& error) {
    refuse(fmt::format("not JSON at byte {}", error.byte), kind);
  } catch (const Json::out_of_range&) {
    refuse("not JSON: a number is too large", kind);
  }
  if (!root.json().is_object()) {
    root.refuse(root.given(), kind);
  }
  return root;
}

}  // namespace haptolith

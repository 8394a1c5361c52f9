#include "haptolith/lab/archive/json_differences.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstddef>

namespace haptolith {

using Json = nlohmann::ordered_json;

std::vector<std::string> differences(const Json& before, const Json& now, const std::string& wording) {
  constexpr std::size_t kMost = 4;
  std::vector<std::string> found;
  std::size_t more = 0;
  const Json flat_before = before.flatten();
  const Json flat_now = now.flatten();
  const auto shown = [](const Json& all, const std::string& key) {
    return all.contains(key) ? all.at(key).dump(-1, ' ', false, Json::error_handler_t::replace) : "nothing";
  };
  const auto differs = [&](const std::string& key) {
    if (found.size() == kMost) {
      ++more;
    } else {
      found.push_back(fmt::format(fmt::runtime(wording), key.substr(1), shown(flat_before, key), shown(flat_now, key)));
    }
  };
  for (const auto& [key, value] : flat_now.items()) {
    if (!flat_before.contains(key) || flat_before.at(key) != value) {
      differs(key);
    }
  }
  for (const auto& [key, value] : flat_before.items()) {
    if (!flat_now.contains(key)) {
      differs(key);
    }
  }
  if (more > 0) {
    found.push_back(fmt::format("and {} more", more));
  }
  return found;
}

}  // namespace haptolith

#include "haptolith/ros2/ros2_name.h"

#include <algorithm>

#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

constexpr std::size_t kLongestName = 200;  // DDS allows 256 bytes, and a prefix

bool isLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

/// Letters, digits, underscores; no digit first.
bool isToken(std::string_view token) {
  return !token.empty() && isLetter(token.front()) &&
         std::ranges::all_of(token, [](char c) { return isLetter(c) || (c >= '0' && c <= '9'); });
}

/// Tokens with a slash before each.
bool isFullName(std::string_view name) {
  if (name.empty() || name.size() > kLongestName) {
    return false;
  }
  while (!name.empty()) {
    const std::size_t end = std::min(name.find('/', 1), name.size());
    if (name.front() != '/' || !isToken(name.substr(1, end - 1))) {
      return false;
    }
    name.remove_prefix(end);
  }
  return true;
}

}  // namespace

void validate(const Ros2Name& name) {
  if (!isToken(name.node) || name.node.size() > kLongestName) {
    throw InvalidParameter("node-name", inQuotes(name.node), "letters, digits and underscores, and no digit first");
  }
  if (name.node_namespace != "/" && !isFullName(name.node_namespace)) {
    throw InvalidParameter("ros-namespace", inQuotes(name.node_namespace),
                           "'/', or names with a slash before each, such as /site/left");
  }
}

std::string Ros2Name::topic(std::string_view name) const {
  const std::string above = node_namespace == "/" ? "" : node_namespace;
  std::string full;
  if (name.starts_with("~/")) {
    full = above + '/' + node + std::string(name.substr(1));
  } else {
    full = name.starts_with('/') ? std::string(name) : above + '/' + std::string(name);
  }
  if (!isFullName(full)) {
    throw InvalidParameter("topic", inQuotes(name), "a topic's name, such as /arm/pose, pose or ~/pose");
  }
  return full;
}

std::string ddsTopic(std::string_view full_name) {
  return "rt" + std::string(full_name);
}

}  // namespace haptolith

#include "output.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "haptolith/core/clock.h"
#include "haptolith/core/error.h"

namespace haptolith {

namespace {
constexpr std::int64_t kUpdateIntervalNs = 100'000'000;
constexpr std::string_view kEraseLine = "\r\033[K";
}  // namespace

void printText(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw Failure(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
  }
}

void printJson(const nlohmann::ordered_json& object) {
  using Json = nlohmann::ordered_json;
  printText(object.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

void printNotice(std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

bool isTerminal(int descriptor) noexcept {
  return isatty(descriptor) == 1;
}

bool isColoured(int descriptor) noexcept {
  const char* no_color = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  const bool refused = no_color != nullptr && *no_color != '\0';
  const bool dumb = terminal != nullptr && std::strcmp(terminal, "dumb") == 0;
  return !refused && !dumb && isTerminal(descriptor);
}

StatusLine::StatusLine() : visible_(isTerminal(STDERR_FILENO)), coloured_(isColoured(STDERR_FILENO)) {}

StatusLine::~StatusLine() {
  clear();
}

void StatusLine::clear() {
  if (next_ns_ != 0) {
    printNotice(kEraseLine);
    next_ns_ = 0;
  }
}

void StatusLine::update(std::string_view text) {
  if (!visible_ || monotonicNs() < next_ns_) {
    return;
  }
  next_ns_ = monotonicNs() + kUpdateIntervalNs;
  printNotice(fmt::format("{}{}{}{}", kEraseLine, coloured_ ? "\033[36m" : "", text, coloured_ ? "\033[0m" : ""));
}

}  // namespace haptolith

#include "output.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>

#include "haptolith/core/clock.h"
#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {
constexpr std::int64_t kUpdateIntervalNs = 100'000'000;
constexpr std::string_view kEraseLine = "\r\033[K";

void writeNotice(std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

namespace {

/// Text comes from files, too: whatever a terminal would obey is shown instead, but for the colours (\033[32m) that we
/// set ourselves, which do no harm.
std::string forTerminal(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t escape = std::min(text.find('\033'), text.size());
    result += plainText(text.substr(0, escape), Lines::kSeveral);
    text.remove_prefix(escape);
    if (text.empty()) {
      break;
    }
    const std::size_t end = text.find_first_not_of("0123456789;", std::min<std::size_t>(2, text.size()));
    const bool colour = text.starts_with("\033[") && end != std::string_view::npos && text[end] == 'm';
    const std::size_t size = colour ? end + 1 : 1;
    result += colour ? std::string(text.substr(0, size)) : plainText(text.substr(0, size));
    text.remove_prefix(size);
  }
  return result;
}

}  // namespace

void printText(std::string_view given) {
  const std::string text = forTerminal(given);
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw Failure(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
  }
}

void printJson(const nlohmann::ordered_json& object) {
  using Json = nlohmann::ordered_json;
  printText(object.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

void printNotice(std::string_view text) noexcept {
  try {
    writeNotice(forTerminal(text));
  } catch (const std::bad_alloc&) {
    writeNotice("haptolith: out of memory\n");
  }
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
    writeNotice(kEraseLine);
    next_ns_ = 0;
  }
}

void StatusLine::update(std::string_view text) {
  if (!visible_ || monotonicNs() < next_ns_) {
    return;
  }
  next_ns_ = monotonicNs() + kUpdateIntervalNs;
  writeNotice(kEraseLine);
  printNotice(fmt::format("{}{}{}", coloured_ ? "\033[36m" : "", plainText(text), coloured_ ? "\033[0m" : ""));
}

}  // namespace haptolith

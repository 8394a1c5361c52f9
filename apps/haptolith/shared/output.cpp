#include "shared/output.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/core/platform/descriptor.h"
#include "haptolith/core/platform/start_thread.h"
#include "haptolith/core/platform/terminal.h"

namespace haptolith {

namespace {

/// Writes to standard error on a thread that may block. The thread exists while there is text to print.
class Posted {
 public:
  ~Posted() { finish(); }

  /// Adds text; a line replaces a pending line.
  void post(std::string text, bool is_line) {
    const std::lock_guard lock(mutex_);
    if (is_line && !waiting_.empty() && waiting_.back().is_line) {
      bytes_ += text.size() - waiting_.back().text.size();
      waiting_.back().text = std::move(text);
      return;
    }
    if (bytes_ + text.size() > kMostBytes) {
      left_out_ += is_line ? 0 : 1;
      return;
    }
    if (left_out_ > 0 && !is_line) {
      text.insert(0,
                  fmt::format("({} messages were dropped: the terminal was too slow)\n", std::exchange(left_out_, 0)));
    }
    bytes_ += text.size();
    waiting_.push_back({std::move(text), is_line});
    if (!thread_.joinable()) {
      thread_ = startThread("the terminal", [this] { print(); });
    }
    changed_.notify_all();
  }

  void printAll() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_.empty() && !printing_; });
  }

  void finish() {
    printAll();
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) {
      thread_.join();
    }
  }

 private:
  struct Text {
    std::string text;
    bool is_line = false;
  };
  static constexpr std::size_t kMostBytes = std::size_t{64} << 10;

  void print() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
      if (waiting_.empty()) {
        return;
      }
      const std::string text = std::move(waiting_.front().text);
      waiting_.pop_front();
      bytes_ -= text.size();
      printing_ = true;
      lock.unlock();
      std::fwrite(text.data(), 1, text.size(), stderr);
      std::fflush(stderr);
      lock.lock();
      printing_ = false;
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Text> waiting_;
  std::size_t bytes_ = 0, left_out_ = 0;
  bool printing_ = false, ends_ = false;
  std::thread thread_;
};

Posted& posted() {
  static Posted messages;
  return messages;
}

constexpr std::int64_t kUpdateIntervalNs = 100'000'000;
constexpr std::int64_t kLineIntervalNs = 10'000'000'000;
constexpr std::string_view kEraseLine = "\r\033[K";

/// Cuts a line of UTF-8 to the width of the terminal; returns all of it if the width is unknown.
std::string_view cutToTerminal(std::string_view line) {
  const std::size_t columns = terminalColumns(kStandardError);
  std::size_t letters = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool begins_letter = (static_cast<unsigned char>(line[i]) & 0xC0U) != 0x80U;
    if (begins_letter && ++letters == columns) {  // the last column stays empty: some terminals wrap after it
      return line.substr(0, i);
    }
  }
  return line;
}

void writeNotice(std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

void post(std::string text) {
  posted().post(std::move(text), false);
}

void printPosted() noexcept {
  posted().printAll();
}

namespace {

/// Escapes control characters for a terminal, because text may come from files. Colours (\033[32m) are kept; they are
/// harmless.
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

void printText(std::string_view text) {
  printPosted();
  const std::string harmless = forTerminal(text);
  if (std::fwrite(harmless.data(), 1, harmless.size(), stdout) != harmless.size() || std::fflush(stdout) != 0) {
    throw Failure(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
  }
}

void printJson(const nlohmann::ordered_json& object) {
  using Json = nlohmann::ordered_json;
  printText(object.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

void printNotice(std::string_view text) noexcept {
  printPosted();
  try {
    writeNotice(forTerminal(text));
  } catch (const std::bad_alloc&) {
    writeNotice("haptolith: out of memory\n");
  }
}

bool isColoured(int descriptor) noexcept {
  const char* no_color = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  const bool refused = no_color != nullptr && *no_color != '\0';
  const bool dumb = terminal != nullptr && std::strcmp(terminal, "dumb") == 0;
  return !refused && !dumb && isTerminal(descriptor);
}

StatusLine::StatusLine()
    : visible_(isTerminal(kStandardError)),
      coloured_(isColoured(kStandardError)),
      next_line_ns_(monotonicNs() + kLineIntervalNs) {}

StatusLine::~StatusLine() {
  clear();
}

bool StatusLine::lineIsDue() noexcept {
  const std::int64_t now_ns = monotonicNs();
  const bool due = now_ns >= next_line_ns_;
  next_line_ns_ = due ? now_ns + kLineIntervalNs : next_line_ns_;
  return due;
}

void StatusLine::clear() {
  if (next_ns_ != 0) {
    posted().post(std::string(kEraseLine), false);
    next_ns_ = 0;
  }
}

void StatusLine::update(std::string_view text) {
  if (!visible_ || monotonicNs() < next_ns_) {
    return;
  }
  next_ns_ = monotonicNs() + kUpdateIntervalNs;
  const std::string plain = plainText(text);
  posted().post(fmt::format("{}{}{}{}", kEraseLine, coloured_ ? "\033[36m" : "", cutToTerminal(plain),
                            coloured_ ? "\033[0m" : ""),
                true);
}

}  // namespace haptolith

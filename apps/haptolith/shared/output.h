#pragma once

#include <fmt/format.h>
#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <string>
#include <string_view>

namespace haptolith {

/// Prints one JSON object and a newline. Numbers that are not finite become null.
/// @throws Failure if writing to standard output fails: full disk, closed pipe.
void printJson(const nlohmann::ordered_json& object);

/// Prints `text`; control characters are escaped as "\u001b" (newlines, tabs and colours are kept). @throws Failure as
/// printJson().
void printText(std::string_view text);

/// Prints `text` on standard error, like printText(), after all text from post(). Errors are ignored, because they
/// cannot be reported.
void printNotice(std::string_view text) noexcept;

/// Whether to colour output to `descriptor`: it is a terminal, without NO_COLOR and TERM=dumb.
[[nodiscard]] bool isColoured(int descriptor) noexcept;

/// Prints `text` on standard error asynchronously, because a terminal may block (Ctrl-S, a hung connection). Text
/// beyond 64 KiB of pending text is dropped; the drop is reported.
void post(std::string text);

/// Waits until all posted text has been printed. The synchronous functions call it first.
void printPosted() noexcept;

/// Status line on standard error that is updated during long work; silent without a terminal. The destructor removes
/// it. Does not wait for the terminal. Not for the tick.
class StatusLine {
 public:
  StatusLine();
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// Shows `text`, at most ten times per second; other calls cost one clock reading.
  void update(std::string_view text);

  /// Shows the progress of long work, returned by `text`: as update(), or without a terminal as a separate line every
  /// 10 s.
  template <class Text>
  void tell(const Text& text) {
    if (visible_) {
      update(text());
    } else if (lineIsDue()) {
      post(fmt::format("haptolith: {}\n", text()));
    }
  }

  /// Clears the line, so that other text can follow.
  void clear();

  /// Whether the line is visible; callers can skip creating the text otherwise.
  [[nodiscard]] bool visible() const noexcept { return visible_; }

 private:
  [[nodiscard]] bool lineIsDue() noexcept;

  bool visible_, coloured_;
  std::int64_t next_ns_ = 0;
  std::int64_t next_line_ns_;
};

}  // namespace haptolith

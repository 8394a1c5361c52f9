#pragma once

#include <fmt/format.h>
#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <string>
#include <string_view>

namespace haptolith {

/// Prints one JSON object and a newline. Numbers that are not finite become null.
/// @throws Failure when standard output does not take it: a full disk, a closed pipe.
void printJson(const nlohmann::ordered_json& object);

/// Prints `text`; control characters in it, which a terminal would obey, are shown as "\u001b" (newlines, tabs and
/// colours stay). @throws Failure as printJson().
void printText(std::string_view text);

/// Prints `text` on standard error, like printText(), after what post() was given. Nobody can be told when that fails,
/// so it never does.
void printNotice(std::string_view text) noexcept;

[[nodiscard]] bool isTerminal(int descriptor) noexcept;

/// Whether to colour what goes to `descriptor`: a terminal, and neither NO_COLOR nor TERM=dumb asks for none.
[[nodiscard]] bool isColoured(int descriptor) noexcept;

/// Prints `text` on standard error soon, and does not wait for it: a terminal need not take anything (Ctrl-S, a hung
/// connection). What comes when 64 KiB wait is left out, and said to be.
void post(std::string text);

/// Waits until all that was posted has been printed. The functions that print at once begin with it.
void printPosted() noexcept;

/// One line on standard error that is written over and over while something takes long; silent when nobody watches.
/// The line vanishes with the object. Waits for no terminal. Not for the tick.
class StatusLine {
 public:
  StatusLine();
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// Shows `text`, at most ten times a second: calls in between cost one clock reading.
  void update(std::string_view text);

  /// Tells how far long work is, as `text` makes it up: as update(), and where no terminal watches with a line of its
  /// own every ten seconds.
  template <class Text>
  void tell(const Text& text) {
    if (visible_) {
      update(text());
    } else if (lineIsDue()) {
      post(fmt::format("haptolith: {}\n", text()));
    }
  }

  /// Wipes the line, so that other text can follow.
  void clear();

  /// Whether anybody sees it; saves making up a text for nobody.
  [[nodiscard]] bool visible() const noexcept { return visible_; }

 private:
  [[nodiscard]] bool lineIsDue() noexcept;

  bool visible_, coloured_;
  std::int64_t next_ns_ = 0;
  std::int64_t next_line_ns_;
};

}  // namespace haptolith

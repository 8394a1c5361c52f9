#pragma once

#include <nlohmann/json.hpp>

#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace haptolith {

/// Chromium without a window, for pictures of the page. It draws without a graphics card, so that a picture does not
/// depend on the machine, and its folder is deleted with it. Not for the tick.
class HeadlessBrowser {
 public:
  struct Options {
    int width_px = 1280, height_px = 720;
    std::function<bool()> stopped;  ///< whether the picture is no longer needed
  };

  /// Starts it; $HAPTOLITH_CHROMIUM names another than the one found in PATH.
  /// @throws Failure when it is missing, naming the Debian package, or it does not start.
  explicit HeadlessBrowser(const Options& options);
  ~HeadlessBrowser();

  // All of these throw Failure: when the browser does not answer, has ended, refuses, or the work is stopped.

  void open(const std::string& url);

  /// The value of a JavaScript expression; when that is a promise, what it resolves to.
  nlohmann::json evaluate(std::string_view expression);

  /// Picture of the page as the bytes of a PNG: a small one to keep, or a quick one for a film.
  enum class Png { kSmall, kQuick };
  std::string screenshot(Png png);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace haptolith

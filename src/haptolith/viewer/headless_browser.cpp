#include "haptolith/viewer/headless_browser.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <span>
#include <system_error>
#include <thread>
#include <utility>

#include "haptolith/core/base64.h"
#include "haptolith/core/error.h"
#include "haptolith/core/platform/child_process.h"
#include "haptolith/core/platform/files.h"
#include "haptolith/core/platform/this_program.h"

// Chromium is steered through two pipes with JSON messages that end in a zero byte (--remote-debugging-pipe; the
// commands are those of https://chromedevtools.github.io/devtools-protocol). A port would be open to every user
// of the machine; and when a pipe closes after a crash of this program, Chromium ends.

namespace haptolith {

namespace {

using namespace std::chrono_literals;
using nlohmann::json;
namespace fs = std::filesystem;

/// A large bed, drawn in software on a busy machine, takes its time.
constexpr auto kTimeout = 300s;
constexpr auto kPatienceAtTheEnd = 3s;

/// Descriptors at which Chromium expects the pipes.
constexpr int kItReads = 3;
constexpr int kItWrites = 4;

constexpr const char* kPackage = "chromium";

/// A folder that goes with the object, and all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::uint64_t number = 0;
    const fs::path folder = fs::temp_directory_path();
    if (!fillWithRandom(std::as_writable_bytes(std::span(&number, 1))) ||
        !createFolder(folder / fmt::format("haptolith-{:016x}", number), true)) {
      throw Failure(fmt::format("cannot create a folder in {}", folder.string()));
    }
    path_ = (folder / fmt::format("haptolith-{:016x}", number)).string();
  }
  ~TemporaryFolder() {
    // Processes that were killed a moment ago may still be writing their last.
    std::error_code error;
    for (int i = 0; i < 20; ++i) {
      fs::remove_all(path_, error);
      if (!fs::exists(path_, error)) {
        return;
      }
      std::this_thread::sleep_for(50ms);
    }
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  std::string path_;
};

/// The name or path to start Chromium by.
std::string chromium() {
  if (const char* named = std::getenv("HAPTOLITH_CHROMIUM"); named != nullptr && *named != '\0') {
    if (!isProgram(named)) {
      throw Failure(
          fmt::format("HAPTOLITH_CHROMIUM={} is not a program; unset it to use the installed Chromium: apt install {}",
                      named, kPackage));
    }
    return named;
  }
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
    if (!programInPath(name).empty()) {
      return name;
    }
  }
  throw Failure(fmt::format("chromium is not installed: apt install {}", kPackage));
}

ChildProcess::Command commandFor(const HeadlessBrowser::Options& options, const std::string& folder) {
  ChildProcess::Command command{
      .arguments = {chromium(), "--headless=new", "--remote-debugging-pipe", "--user-data-dir=" + folder,
                    // Equal pictures with and without a graphics card.
                    "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--force-device-scale-factor=1",
                    "--force-color-profile=srgb", "--hide-scrollbars", "--mute-audio",
                    fmt::format("--window-size={},{}", options.width_px, options.height_px),
                    // Nothing but the page: no welcome, no updates, no questions to servers.
                    "--no-first-run", "--no-default-browser-check", "--disable-background-networking",
                    "--disable-component-update", "--disable-breakpad", "--disable-extensions", "--disable-sync",
                    // Containers have a /dev/shm that is too small.
                    "--disable-dev-shm-usage"},
      .package = kPackage,
      .environment = {"TMPDIR=" + folder},
      .most_cpu = std::chrono::hours(24)};  // an hour of film is drawn in some hours
  if (hasAllRights()) {
    command.arguments.emplace_back("--no-sandbox");  // Chromium refuses to start as root otherwise
  }
  return command;
}

}  // namespace

class HeadlessBrowser::Implementation {
 public:
  explicit Implementation(const Options& options)
      : options_(options),
        words_(temporaryFile()),
        process_(commandFor(options, folder_.path()), {{temporaryFile(), kStandardInput},
                                                       {words_, kStandardOutput},
                                                       {words_, kStandardError},
                                                       {to_.to_read, kItReads},
                                                       {from_.to_write, kItWrites}}) {
    to_.to_read.close();
    from_.to_write.close();
    const json page = call("Target.createTarget", {{"url", "about:blank"}});
    const json session = call("Target.attachToTarget", {{"targetId", page["targetId"]}, {"flatten", true}});
    session_ = session["sessionId"];
    call("Emulation.setDeviceMetricsOverride",
         {{"width", options.width_px}, {"height", options.height_px}, {"deviceScaleFactor", 1}, {"mobile", false}});
  }

  ~Implementation() {
    // Asked first, it ends its own processes and clears up; whatever does not listen is killed.
    session_.clear();
    const std::function<bool()> never;
    const std::string close = messageFor("Browser.close", json::object());
    try {
      if (writeAll(to_.to_write, close, {.until = std::chrono::steady_clock::now() + 1s, .stopped = never})) {
        process_.endsWithin(kPatienceAtTheEnd);
      }
    } catch (const Failure&) {  // it will be killed
    }
  }

  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  /// Sends a command and waits for its result; events in between are not for us.
  json call(const std::string& method, const json& parameters) {
    const Deadline deadline{.until = std::chrono::steady_clock::now() + kTimeout, .stopped = options_.stopped};
    const std::string message = messageFor(method, parameters);
    if (!writeAll(to_.to_write, message, deadline)) {
      throwBecauseItEnded();
    }
    while (true) {
      json answer = json::parse(nextMessage(deadline));
      if (answer.value("id", 0) != id_) {
        continue;
      }
      if (answer.contains("error")) {
        throw Failure(fmt::format("Chromium refuses {}: {}", method, answer["error"].value("message", "")));
      }
      return std::move(answer["result"]);
    }
  }

 private:
  std::string messageFor(const std::string& method, const json& parameters) {
    json message{{"id", ++id_}, {"method", method}, {"params", parameters}};
    if (!session_.empty()) {
      message["sessionId"] = session_;
    }
    return message.dump(-1, ' ', false, json::error_handler_t::replace) + '\0';
  }

  std::string nextMessage(const Deadline& deadline) {
    std::size_t end = std::string::npos, searched = 0;
    while ((end = received_.find('\0', searched)) == std::string::npos) {
      searched = received_.size();
      if (!readSome(from_.to_read, received_, deadline)) {
        throwBecauseItEnded();
      }
    }
    std::string message = received_.substr(0, end);
    received_.erase(0, end + 1);
    return message;
  }

  /// Throws with the end of its output, which has the reason.
  [[noreturn]] void throwBecauseItEnded() const {
    constexpr std::size_t kMost = 600;
    std::string words = contentOf(words_);
    if (words.size() > kMost) {
      words = words.substr(words.size() - kMost);
    }
    throw Failure("Chromium has ended; it says" + (words.empty() ? " nothing" : ":\n" + words));
  }

  const Options options_;
  TemporaryFolder folder_;
  Pipe to_, from_;
  Descriptor words_;  ///< its standard output and error
  ChildProcess process_;
  std::string session_;  ///< session of the page; empty: messages go to the browser
  std::string received_;
  int id_ = 0;
};

HeadlessBrowser::HeadlessBrowser(const Options& options) : implementation_(std::make_unique<Implementation>(options)) {}

HeadlessBrowser::~HeadlessBrowser() = default;

void HeadlessBrowser::open(const std::string& url) {
  const json answer = implementation_->call("Page.navigate", {{"url", url}});
  if (answer.contains("errorText")) {
    throw Failure(fmt::format("Chromium cannot open {}: {}", url, answer["errorText"].get<std::string>()));
  }
}

json HeadlessBrowser::evaluate(std::string_view expression) {
  json answer = implementation_->call("Runtime.evaluate",
                                      {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
  if (answer.contains("exceptionDetails")) {
    throw Failure(fmt::format("the page fails: {}", answer["result"].value("description", "")));
  }
  return answer["result"].value("value", json());
}

std::string HeadlessBrowser::screenshot(Png png) {
  const json answer =
      implementation_->call("Page.captureScreenshot", {{"format", "png"}, {"optimizeForSpeed", png == Png::kQuick}});
  const std::optional<std::string> picture = fromBase64(answer["data"].get_ref<const std::string&>());
  if (!picture) {
    throw Failure("the browser sent a picture that is not base64");
  }
  return *picture;
}

}  // namespace haptolith

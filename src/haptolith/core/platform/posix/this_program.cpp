#include "haptolith/core/platform/this_program.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "haptolith/core/error.h"

namespace haptolith {

namespace fs = std::filesystem;

std::vector<std::string> programArguments(int argc, const char* const* argv) {
  return {argv, argv + argc};
}

fs::path programFile() {
  return fs::read_symlink("/proc/self/exe");
}

std::string programFileName(std::string_view name) {
  return std::string(name);
}

void becomeProgram(const fs::path& file, const std::vector<std::string>& arguments) {
  std::vector<std::string> texts = arguments;
  std::vector<char*> pointers;
  for (std::string& text : texts) {
    pointers.push_back(text.data());
  }
  pointers.push_back(nullptr);
  execv(file.c_str(), pointers.data());
  throw Failure(fmt::format("cannot start {}: {}", file.string(), std::strerror(errno)));
}

fs::path programInPath(const std::string& name) {
  const char* const path = std::getenv("PATH");
  std::string_view folders = path == nullptr ? "" : path;
  while (!folders.empty()) {
    const std::string_view folder = folders.substr(0, folders.find(':'));
    folders.remove_prefix(std::min(folder.size() + 1, folders.size()));
    if (!folder.empty() && isProgram(fs::path(folder) / name)) {
      return fs::path(folder) / name;
    }
  }
  return {};
}

bool isProgram(const fs::path& file) noexcept {
  return access(file.c_str(), X_OK) == 0;
}

std::int64_t processNumber() noexcept {
  return getpid();
}

bool hasAllRights() noexcept {
  return geteuid() == 0;
}

std::string hostName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::string systemName() {
  utsname system{};
  return uname(&system) == 0 ? fmt::format("{} {} {}", system.sysname, system.release, system.machine) : "";
}

std::size_t raiseFileLimit(std::size_t most) noexcept {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) != 0) {
    return 0;
  }
  const rlimit more{std::min<rlim_t>(most, files.rlim_max), files.rlim_max};
  if (more.rlim_cur > files.rlim_cur && setrlimit(RLIMIT_NOFILE, &more) == 0) {
    return more.rlim_cur;
  }
  return files.rlim_cur;
}

void makeClosedPipesErrors() noexcept {
  std::signal(SIGPIPE, SIG_IGN);
}

namespace {

std::atomic<void (*)()> end_handler{nullptr};
static_assert(std::atomic<void (*)()>::is_always_lock_free);

void askToEnd(int /*signal*/) {
  end_handler.load()();
}

}  // namespace

void onEndAsked(void (*handler)()) noexcept {
  end_handler = handler;
  struct sigaction action {};
  action.sa_handler = askToEnd;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before {};
  if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) {  // nohup ignores it
    sigaction(SIGHUP, &action, nullptr);
  }
}

}  // namespace haptolith

#include "haptolith/study/store/runner_lock.h"

#include <fmt/format.h>

#include <string>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

FileLock lockBeside(const std::filesystem::path& study) {
  try {
    return FileLock(study.string() + "-lock");
  } catch (const Failure& failure) {
    throw Failure(fmt::format("cannot run {}: {}", study.string(), failure.what()));
  }
}

}  // namespace

RunnerLock::RunnerLock(const std::filesystem::path& study) : lock_(lockBeside(study)) {
  if (!lock_.held()) {
    const std::string holder = lock_.holder().empty() ? "" : fmt::format(" (process {})", lock_.holder());
    throw Failure(
        fmt::format("cannot run {}: another program{} already runs it; wait until it ends (`haptolith study status` "
                    "works meanwhile)",
                    study.string(), holder));
  }
}

}  // namespace haptolith

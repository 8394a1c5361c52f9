#include "haptolith/core/platform/shared_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <utility>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

/// Without the library's name in front, which our messages begin with.
std::string loadersReason(const std::filesystem::path& library) {
  const char* told = dlerror();
  std::string reason = told != nullptr ? told : "no reason given";
  if (const std::string name = library.string() + ": "; reason.starts_with(name)) {
    reason.erase(0, name.size());
  }
  return reason;
}

}  // namespace

// RTLD_NODELETE: a library may have threads that outlive its last function, and code must not vanish under them.
SharedLibrary::SharedLibrary(std::filesystem::path path)
    : path_(std::move(path)), handle_(dlopen(path_.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE)) {
  if (handle_ == nullptr) {
    throw Failure(fmt::format("cannot load {}: {}", path_.string(), loadersReason(path_)));
  }
}

SharedLibrary::Symbol SharedLibrary::symbol(const char* name) const {
  void* const found = dlsym(handle_.get(), name);
  if (found == nullptr) {
    throw Failure(fmt::format("{} has no function {}: {}", path_.string(), name, loadersReason(path_)));
  }
  return {found};
}

void SharedLibrary::Closer::operator()(void* handle) const noexcept {
  dlclose(handle);
}

}  // namespace haptolith

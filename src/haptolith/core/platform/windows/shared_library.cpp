#include "haptolith/core/platform/shared_library.h"

#include <fmt/format.h>
#include <windows.h>

#include <system_error>
#include <utility>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

std::string loadersReason() {
  return std::system_category().message(static_cast<int>(GetLastError()));
}

}  // namespace

SharedLibrary::SharedLibrary(std::filesystem::path path)
    : path_(std::move(path)), handle_(LoadLibraryW(path_.c_str())) {
  if (handle_ == nullptr) {
    throw Failure(fmt::format("cannot load {}: {}", path_.string(), loadersReason()));
  }
}

SharedLibrary::Symbol SharedLibrary::symbol(const char* name) const {
  const FARPROC found = GetProcAddress(static_cast<HMODULE>(handle_.get()), name);
  if (found == nullptr) {
    throw Failure(fmt::format("{} has no function {}: {}", path_.string(), name, loadersReason()));
  }
  return {reinterpret_cast<void*>(found)};
}

// It stays: a library may have threads that outlive its last function, and code must not vanish under them.
void SharedLibrary::Closer::operator()(void* /*handle*/) const noexcept {}

}  // namespace haptolith

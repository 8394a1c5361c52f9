#include "haptolith/recording/hdf5_handle.h"

#include <fmt/format.h>

#include <atomic>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "haptolith/core/error.h"

namespace haptolith::hdf5 {

namespace {

/// The file driver writes the system's words into its description: "..., error message = 'File too large', buf = ...".
std::string systemReason(std::string_view description) {
  constexpr std::string_view kBefore = "error message = '";
  const std::size_t begin = description.find(kBefore);
  if (begin == std::string_view::npos) {
    return {};
  }
  description.remove_prefix(begin + kBefore.size());
  return std::string(description.substr(0, description.find('\'')));
}

struct Found {
  std::string system, deepest;
};

herr_t look(unsigned, const H5E_error2_t* error, void* data) {
  auto& found = *static_cast<Found*>(data);
  if (error->desc != nullptr) {
    found.deepest = error->desc;  // they come from the outermost to the innermost
    if (std::string system = systemReason(error->desc); !system.empty()) {
      found.system = std::move(system);
    }
  }
  return 0;
}

/// Whether HDF5 still holds something that it could not close.
std::atomic<bool> stuck{false};

void closeAtExit() {
  if (!stuck) {
    H5close();
  }
}

}  // namespace

bool Handle::close() noexcept {
  const hid_t id = std::exchange(id_, H5I_INVALID_HID);
  const bool closed = id < 0 || H5Idec_ref(id) >= 0;
  if (!closed) {
    stuck = true;
  }
  return closed;
}

void prepareThread() noexcept {
  // At the program's end HDF5 would close itself, and crash over a dataset that the disk did not take.
  [[maybe_unused]] static const bool kOnce = H5dont_atexit() >= 0 && std::atexit(closeAtExit) == 0;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

std::string reason() {
  Found found;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, look, &found);
  if (!found.system.empty()) {
    return found.system;
  }
  return found.deepest.empty() ? "HDF5 gives no reason" : "HDF5 says: " + found.deepest;
}

Handle handle(hid_t id, const char* what) {
  return Handle(done(id, what));
}

void fail(const char* what) {
  throw Failure(fmt::format("cannot {}: {}", what, reason()));
}

}  // namespace haptolith::hdf5

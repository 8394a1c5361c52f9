#pragma once

// Later versions of HDF5 know what this one does by the same names.
#define H5_USE_110_API
#include <hdf5.h>

#include <string>
#include <utility>

namespace haptolith::hdf5 {

/// An HDF5 identifier of any kind, given back with the object.
class Handle {
 public:
  Handle() = default;
  explicit Handle(hid_t id) noexcept : id_(id) {}
  ~Handle() { close(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }

  [[nodiscard]] hid_t id() const noexcept { return id_; }

  /// False when what was still to be written could not be.
  bool close() noexcept;

 private:
  hid_t id_ = H5I_INVALID_HID;
};

/// To be called in each thread before anything else of HDF5: keeps it from printing its errors, which become ours.
void prepareThread() noexcept;

/// Why the last call of this thread went wrong: the system's reason where there is one ("No space left on device"),
/// else HDF5's.
[[nodiscard]] std::string reason();

/// The identifier that a call gave. @throws Failure "cannot WHAT: reason()" when it gave none.
[[nodiscard]] Handle handle(hid_t id, const char* what);

/// Returns a call's result. @throws Failure as handle() when that is negative.
template <class Status>
Status done(Status status, const char* what);

[[noreturn]] void fail(const char* what);

template <class Status>
Status done(Status status, const char* what) {
  if (status < 0) {
    fail(what);
  }
  return status;
}

}  // namespace haptolith::hdf5

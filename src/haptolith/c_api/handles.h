#pragma once

#include <haptolith/haptolith.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <utility>

namespace haptolith::library {

/// Target of a handle of the C interface, with its usage state. Its memory is never freed, so that a
/// destroyed handle is distinguishable from a live one until its place is reused.
struct Handle {
  std::atomic<bool> alive{false};
  std::atomic<bool> in_use{false};
  std::atomic<bool> observed{false};  ///< for a loop: by the thread that watches it
};

template <class T>
struct HandleOf : Handle {
  using Object = T;
  std::uint32_t kind = 0;  ///< kind of handle, so that kinds cannot be confused
  std::unique_ptr<T> object;
};

/// The places of all handles of one kind. A place that is free is taken again as late as possible.
template <class H>
class Places {
 public:
  [[nodiscard]] static H* take(std::unique_ptr<typename H::Object> object) {
    Places& places = all();
    const std::lock_guard lock(places.mutex_);
    constexpr std::size_t kFreeAtLeast = 64;
    H* handle = nullptr;
    if (places.free_.size() > kFreeAtLeast) {
      handle = places.free_.front();
      places.free_.pop_front();
    } else {
      handle = &places.places_.emplace_back();
      handle->kind = H::kKind;
    }
    handle->object = std::move(object);
    handle->alive.store(true, std::memory_order_release);
    return handle;
  }

  /// Destroys the target of the handle; the caller has claimed it.
  static void giveBack(H& handle) {
    handle.alive.store(false, std::memory_order_release);
    handle.object.reset();
    handle.observed.store(false, std::memory_order_release);
    handle.in_use.store(false, std::memory_order_release);
    Places& places = all();
    const std::lock_guard lock(places.mutex_);
    places.free_.push_back(&handle);
  }

 private:
  static Places& all() {
    static Places& places = *new Places;  // for ever: a handle may be destroyed while the program ends
    return places;
  }

  std::mutex mutex_;
  std::deque<H> places_;
  std::deque<H*> free_;
};

/// The right to use a handle, for as long as this lives. May be taken at 1 kHz.
template <class H>
class Claim {
 public:
  explicit Claim(const H* handle, std::atomic<bool> Handle::*side = &Handle::in_use) noexcept : side_(side) {
    if (handle == nullptr) {
      status_ = HAPTO_NULL;
    } else if (handle->kind != H::kKind || !handle->alive.load(std::memory_order_acquire)) {
      status_ = HAPTO_DESTROYED;
    } else {
      take(const_cast<H&>(*handle));
    }
  }
  ~Claim() {
    if (handle_ != nullptr) {
      (handle_->*side_).store(false, std::memory_order_release);
    }
  }
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  Claim(Claim&& other) noexcept
      : side_(other.side_), handle_(std::exchange(other.handle_, nullptr)), status_(other.status_) {}
  Claim& operator=(Claim&&) = delete;

  /// HAPTO_OK, or why it cannot be used.
  [[nodiscard]] std::int32_t status() const noexcept { return status_; }
  [[nodiscard]] typename H::Object& operator*() const noexcept { return *handle_->object; }
  [[nodiscard]] typename H::Object* operator->() const noexcept { return handle_->object.get(); }

  /// Destroys what it points to, and the claim with it.
  void destroy() { Places<H>::giveBack(*std::exchange(handle_, nullptr)); }
  /// The handle has been destroyed through another claim to it.
  void forget() noexcept { handle_ = nullptr; }

 private:
  void take(H& handle) noexcept {
    if ((handle.*side_).exchange(true, std::memory_order_acq_rel)) {
      status_ = HAPTO_BUSY;
    } else if (!handle.alive.load(std::memory_order_acquire)) {  // another thread was quicker
      (handle.*side_).store(false, std::memory_order_release);
      status_ = HAPTO_DESTROYED;
    } else {
      handle_ = &handle;
    }
  }

  std::atomic<bool> Handle::*side_;
  H* handle_ = nullptr;
  std::int32_t status_ = HAPTO_OK;
};

}  // namespace haptolith::library

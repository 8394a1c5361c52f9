#pragma once

#include <utility>

#include "haptolith/core/platform/files.h"

namespace haptolith {

/// Numbers under which a program finds what it reads, writes and complains to.
inline constexpr int kStandardInput = 0, kStandardOutput = 1, kStandardError = 2;

/// A file descriptor that is closed with the object, and that no child inherits by accident.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) noexcept : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }

  [[nodiscard]] int number() const noexcept { return number_; }
  void close() noexcept {
    if (number_ >= 0) {
      closeFile(std::exchange(number_, -1));
    }
  }

 private:
  int number_ = -1;
};

}  // namespace haptolith

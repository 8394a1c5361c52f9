#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>

#include "haptolith/core/vec.h"

namespace haptolith {

static_assert(std::endian::native == std::endian::little, "packets are copied as they lie in memory");
static_assert(sizeof(double) == 8 && sizeof(float) == 4);

/// Reads a packet's values one after the other; its maker has checked the size. May be called in the tick.
class PacketReader {
 public:
  explicit PacketReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class T>
  void read(T& value) noexcept {
    std::memcpy(&value, rest_.data(), sizeof(T));
    rest_ = rest_.subspan(sizeof(T));
  }
  template <class T>
  [[nodiscard]] T next() noexcept {
    T value;
    read(value);
    return value;
  }
  /// Numbers of the kind T, a float or a double.
  template <class T = double>
  void readVector(Vec3& v) noexcept {
    for (int i = 0; i < 3; ++i) {
      v[i] = static_cast<double>(next<T>());
    }
  }
  /// w x y z, as received: not normalised.
  template <class T = double>
  void readQuaternion(Quat& q) noexcept {
    q.w() = static_cast<double>(next<T>());
    q.x() = static_cast<double>(next<T>());
    q.y() = static_cast<double>(next<T>());
    q.z() = static_cast<double>(next<T>());
  }
  [[nodiscard]] bool nextIs(std::string_view magic) noexcept {
    const bool is = std::memcmp(rest_.data(), magic.data(), magic.size()) == 0;
    rest_ = rest_.subspan(magic.size());
    return is;
  }

 private:
  std::span<const std::byte> rest_;
};

/// Writes a packet's values one after the other. May be called in the tick.
class PacketWriter {
 public:
  explicit PacketWriter(std::span<std::byte> bytes) : rest_(bytes) {}

  template <class T>
  void write(const T& value) noexcept {
    std::memcpy(rest_.data(), &value, sizeof(T));
    rest_ = rest_.subspan(sizeof(T));
  }
  template <class T = double>
  void writeVector(const Vec3& v) noexcept {
    for (int i = 0; i < 3; ++i) {
      write(static_cast<T>(v[i]));
    }
  }
  template <class T = double>
  void writeQuaternion(const Quat& q) noexcept {
    write(static_cast<T>(q.w()));
    write(static_cast<T>(q.x()));
    write(static_cast<T>(q.y()));
    write(static_cast<T>(q.z()));
  }
  void writeMagic(std::string_view magic) noexcept {
    std::memcpy(rest_.data(), magic.data(), magic.size());
    rest_ = rest_.subspan(magic.size());
  }

 private:
  std::span<std::byte> rest_;
};

}  // namespace haptolith

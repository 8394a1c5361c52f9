#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace haptolith {

/// Arrays that SIMD registers load whole: they begin at a cache line.
template <class T>
struct CacheAligned {
  using value_type = T;  // NOLINT(readability-identifier-naming): the standard's name
  static constexpr std::align_val_t kLine{64};

  CacheAligned() = default;
  template <class Other>
  CacheAligned(const CacheAligned<Other>&) noexcept {}  // NOLINT(google-explicit-constructor): allocators convert

  [[nodiscard]] T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kLine)); }
  void deallocate(T* p, std::size_t) noexcept { ::operator delete(p, kLine); }
  friend bool operator==(const CacheAligned&, const CacheAligned&) noexcept { return true; }
};
using FloatArray = std::vector<float, CacheAligned<float>>;

}  // namespace haptolith

#pragma once

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <cstddef>
#include <new>
#include <vector>

namespace haptolith {

/// Arrays that SIMD registers load whole: they begin at a cache line. Large ones ask for large pages, which take fewer
/// entries of the processor's table of addresses.
template <class T>
struct CacheAligned {
  using value_type = T;  // NOLINT(readability-identifier-naming): the standard's name
  static constexpr std::align_val_t kLine{64};

  CacheAligned() = default;
  template <class Other>
  CacheAligned(const CacheAligned<Other>&) noexcept {}  // NOLINT(google-explicit-constructor): allocators convert

  static constexpr std::align_val_t kLargePage{std::size_t{1} << 21};

  [[nodiscard]] T* allocate(std::size_t n) {
    void* const bytes = ::operator new(n * sizeof(T), alignmentOf(n));
#ifdef __linux__
    if (alignmentOf(n) == kLargePage) {
      (void)::madvise(bytes, n * sizeof(T), MADV_HUGEPAGE);  // a wish
    }
#endif
    return static_cast<T*>(bytes);
  }
  void deallocate(T* p, std::size_t n) noexcept {
    ::operator delete(p, alignmentOf(n));
  }
  friend bool operator==(const CacheAligned&, const CacheAligned&) noexcept {
    return true;
  }

 private:
  static constexpr std::align_val_t alignmentOf(std::size_t n) noexcept {
    return n * sizeof(T) < 4 * static_cast<std::size_t>(kLargePage) ? kLine : kLargePage;
  }
};
using FloatArray = std::vector<float, CacheAligned<float>>;

}  // namespace haptolith

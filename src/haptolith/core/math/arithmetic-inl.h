// Arithmetic of the kernels with the same bits on every instruction set, under Highway's names for single numbers too,
// so that one expression serves both. Quotients and roots are IEEE 754's instead of a processor's first guess. MulAdd,
// MulSub and NegMulAdd of vectors are fused, with one rounding; SSE and WebAssembly have no such instruction and come
// to separate bits (kFused). Included again for every target, therefore the toggled guard (Highway's idiom).

#if defined(HAPTOLITH_ARITHMETIC_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HAPTOLITH_ARITHMETIC_INL_H_
#undef HAPTOLITH_ARITHMETIC_INL_H_
#else
#define HAPTOLITH_ARITHMETIC_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/math/portable_math.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

/// Whether products are added with one rounding.
inline constexpr bool kFused = HWY_TARGET == HWY_SCALAR || (HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2) || HWY_ARCH_ARM_A64;

// --- single numbers: products and sums are rounded separately ---

inline double larger(double a, double b) {
  return std::max(a, b);
}
inline float larger(float a, float b) {
  return std::max(a, b);
}
inline double smaller(double a, double b) {
  return std::min(a, b);
}
inline float smaller(float a, float b) {
  return std::min(a, b);
}

inline double MulAdd(double a, double b, double c) {
  return a * b + c;
}
inline float MulAdd(float a, float b, float c) {
  return a * b + c;
}
inline double MulSub(double a, double b, double c) {
  return a * b - c;
}
inline float MulSub(float a, float b, float c) {
  return a * b - c;
}
inline double NegMulAdd(double a, double b, double c) {
  return c - a * b;
}
inline float NegMulAdd(float a, float b, float c) {
  return c - a * b;
}
inline double Inverse(double a) {
  return 1 / a;
}
inline float Inverse(float a) {
  return 1 / a;
}
inline double InverseSqrt(double a) {
  return 1 / std::sqrt(a);
}
inline float InverseSqrt(float a) {
  return 1 / std::sqrt(a);
}

// --- vectors ---

using VectorOfFloats = hwy::HWY_NAMESPACE::Vec<hwy::HWY_NAMESPACE::CappedTag<float, 16> >;

#if HWY_TARGET == HWY_SCALAR

/// Highway's has two roundings here.
HWY_INLINE VectorOfFloats MulAdd(VectorOfFloats a, VectorOfFloats b, VectorOfFloats c) {
  return VectorOfFloats(portable::fma(a.raw, b.raw, c.raw));
}
HWY_INLINE VectorOfFloats MulSub(VectorOfFloats a, VectorOfFloats b, VectorOfFloats c) {
  return VectorOfFloats(portable::fma(a.raw, b.raw, -c.raw));
}
HWY_INLINE VectorOfFloats NegMulAdd(VectorOfFloats a, VectorOfFloats b, VectorOfFloats c) {
  return VectorOfFloats(portable::fma(-a.raw, b.raw, c.raw));
}

#endif

/// Returns the second of two equal numbers, and of a number and NaN, as x86 does; others put -0 below 0.
template <class V>
HWY_INLINE V larger(V a, V b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR
  return hwy::HWY_NAMESPACE::Max(a, b);
#else
  return hwy::HWY_NAMESPACE::IfThenElse(a > b, a, b);
#endif
}
template <class V>
HWY_INLINE V smaller(V a, V b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR
  return hwy::HWY_NAMESPACE::Min(a, b);
#else
  return hwy::HWY_NAMESPACE::IfThenElse(a < b, a, b);
#endif
}

template <class V>
HWY_INLINE V Inverse(V a) {
  return hwy::HWY_NAMESPACE::Set(hwy::HWY_NAMESPACE::DFromV<V>(), 1) / a;
}

template <class V>
HWY_INLINE V InverseSqrt(V a) {
  return Inverse(hwy::HWY_NAMESPACE::Sqrt(a));
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

#include "haptolith/bed/kernel/simd_target.h"

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "haptolith/bed/kernel/simd_target.cpp"
#include <hwy/foreach_target.h>  // before highway.h
#include <hwy/highway.h>
#include "haptolith/core/math/arithmetic-inl.h"
// clang-format on

#include <cstdlib>
#include <string>

#include "haptolith/core/error.h"

HWY_BEFORE_NAMESPACE();
namespace haptolith::HWY_NAMESPACE {

const char* targetName() {
  return hwy::TargetName(HWY_TARGET);
}

const char* nameOfArithmetic() {
  return kFused ? "fused" : "unfused";
}

}  // namespace haptolith::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace haptolith {

HWY_EXPORT(targetName);
HWY_EXPORT(nameOfArithmetic);

const char* simdTarget() noexcept {
  return HWY_DYNAMIC_DISPATCH(targetName)();
}

const char* arithmetic() noexcept {
  return HWY_DYNAMIC_DISPATCH(nameOfArithmetic)();
}

std::string targetsWith(std::string_view arithmetic) {
  return arithmetic == "unfused" ? "HAPTOLITH_SIMD=SSE4" : "HAPTOLITH_SIMD=AVX2 or SCALAR";
}

void useSimdTarget(std::string_view name) {
  std::string there;
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    const std::int64_t target = targets & -targets;
    const std::string shown = instructionSetName(hwy::TargetName(target));
    if (name == hwy::TargetName(target) || name == shown) {
      hwy::SetSupportedTargetsForTest(target);
      return;
    }
    there += (there.empty() ? "" : ", ") + shown;
  }
  throw InvalidParameter("HAPTOLITH_SIMD", std::string(name), "one of " + there + " on this machine");
}

void useSimdTargetOfEnvironment() {
  if (const char* name = std::getenv("HAPTOLITH_SIMD"); name != nullptr && *name != '\0') {
    useSimdTarget(name);
  }
}

}  // namespace haptolith
#endif  // HWY_ONCE

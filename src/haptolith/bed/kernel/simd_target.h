#pragma once

#include <string_view>

namespace haptolith {

/// Name of the instruction set in use, for example "AVX3" (Highway's names; AVX3 is AVX-512).
[[nodiscard]] const char* simdTarget() noexcept;

/// Uses this instruction set from now on instead of the best the machine has. Not for the tick.
/// @throws InvalidParameter when the machine does not have it, with those it has.
void useSimdTarget(std::string_view name);

/// The one that HAPTOLITH_SIMD in the environment names, if it names one. @throws as useSimdTarget().
void useSimdTargetOfEnvironment();

}  // namespace haptolith

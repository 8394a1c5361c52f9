#pragma once

#include <string>
#include <string_view>

namespace haptolith {

/// Name of the instruction set in use, for example "AVX3" (Highway's names; AVX3 is AVX-512).
[[nodiscard]] const char* simdTarget() noexcept;

/// The set of bits that the instruction set in use comes to: "fused" (AVX2, AVX-512, NEON, SCALAR), or "unfused"
/// without fused multiplication and addition (SSE, WebAssembly). Same version, scene and movements: same bits on every
/// machine.
[[nodiscard]] const char* arithmetic() noexcept;

/// Returns the setting for a set of bits on this machine: "HAPTOLITH_SIMD=AVX2 or SCALAR".
[[nodiscard]] std::string targetsWith(std::string_view arithmetic);

/// Returns a target's name for people: "AVX-512" for "AVX3". Files and JSON contain simdTarget().
[[nodiscard]] inline std::string instructionSetName(std::string_view target) {
  constexpr std::string_view kAvx512 = "AVX3";
  return target.starts_with(kAvx512) ? std::string("AVX-512").append(target.substr(kAvx512.size()))
                                     : std::string(target);
}

/// Uses this instruction set, by either name, from now on instead of the best the machine has. Not for the tick.
/// @throws InvalidParameter when the machine does not have it, with those it has.
void useSimdTarget(std::string_view name);

/// The one that HAPTOLITH_SIMD in the environment names, if it names one. @throws as useSimdTarget().
void useSimdTargetOfEnvironment();

}  // namespace haptolith

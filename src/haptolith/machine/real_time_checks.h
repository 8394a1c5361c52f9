#pragma once

#include <filesystem>
#include <vector>

#include "haptolith/haptics/loop/deadline_miss.h"
#include "haptolith/machine/check.h"
#include "haptolith/machine/wake_ups.h"

namespace haptolith {

/// The latest wake-up that the loop can live with, in us: of 1000 us, 800 are left for a tick's work and what it sends.
inline constexpr double kLatestWakeUp_us = 1000 * kWakeUpShare;

/// Names of checks.
inline constexpr const char* kCpuCheck = "CPUs";
inline constexpr const char* kWakeUpCheck = "wake-up";

/// Whether this machine can run the loop in real time: kernel, rights, CPUs and wake-up latency. Unreadable
/// properties are reported as such and count as neither good nor bad, unless the measurement decides. Not for the tick.
/// @param measured  from measureWakeUps(): a thread's privileges and wake-up latency.
/// @param root  where proc/, sys/ and dev/ are; another folder in tests.
[[nodiscard]] std::vector<Check> realTimeChecks(const WakeUps& measured, const std::filesystem::path& root = "/");

}  // namespace haptolith

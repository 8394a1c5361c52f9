#include "haptolith/core/platform/threads.h"

#include <avrt.h>
#include <windows.h>

#include <cerrno>

namespace haptolith {

namespace {

/// Windows has processors in groups of 64, and a thread runs in one of them.
constexpr std::size_t kGroup = 64;

CpuSet cpuSetOf(DWORD_PTR mask) noexcept {
  return CpuSet(mask);
}

/// Membership of the calling thread in the group of tasks that Windows favours.
struct Favoured {
  HANDLE task = nullptr;

  ~Favoured() { leave(); }
  bool join() noexcept {
    DWORD index = 0;
    if (task == nullptr) {
      task = AvSetMmThreadCharacteristicsW(L"Pro Audio", &index);
    }
    return task != nullptr;
  }
  void leave() noexcept {
    if (task != nullptr) {
      AvRevertMmThreadCharacteristics(task);
      task = nullptr;
    }
  }
};
thread_local Favoured favoured;
thread_local int priority_asked = 0;

}  // namespace

CpuSet usableCpus() {
  DWORD_PTR process = 0;
  DWORD_PTR system = 0;
  GetProcessAffinityMask(GetCurrentProcess(), &process, &system);
  return cpuSetOf(process);
}

CpuSet cpusOfThisThread() noexcept {
  GROUP_AFFINITY affinity{};
  return GetThreadGroupAffinity(GetCurrentThread(), &affinity) != 0 ? cpuSetOf(affinity.Mask) : CpuSet();
}

int runThisThreadOn(const CpuSet& cpus) noexcept {
  DWORD_PTR mask = 0;
  for (std::size_t cpu = 0; cpu < kGroup; ++cpu) {
    mask |= cpus[cpu] ? DWORD_PTR{1} << cpu : 0;
  }
  return SetThreadAffinityMask(GetCurrentThread(), mask) != 0 ? 0 : EINVAL;
}

int priorityOfThisThread() noexcept {
  return priority_asked;
}

int setPriorityOfThisThread(int priority) noexcept {
  if (priority == 0) {
    favoured.leave();
    priority_asked = 0;
    return SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_NORMAL) != 0 ? 0 : EPERM;
  }
  const bool granted = favoured.join() || SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_TIME_CRITICAL) != 0;
  priority_asked = granted ? priority : 0;
  return granted ? 0 : EPERM;
}

std::string_view schedulerName(bool real_time) noexcept {
  return real_time ? "MMCSS Pro Audio" : "normal";
}

void wakeThisThreadPromptly() noexcept {}  // by the kind of timer: clock.cpp

// Only memory that is named page by page can be locked.
int lockMemory() noexcept {
  return ENOSYS;
}

}  // namespace haptolith

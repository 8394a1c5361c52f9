#include "haptolith/haptics/real_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/threads.h"

namespace haptolith {

namespace {

/// For example "0-3,6".
std::string text(const CpuSet& cpus) {
  std::string list;
  for (std::size_t first = 0; first < cpus.size(); ++first) {
    if (!cpus[first]) {
      continue;
    }
    std::size_t last = first;
    while (last + 1 < cpus.size() && cpus[last + 1]) {
      ++last;
    }
    list += fmt::format("{}{}{}", list.empty() ? "" : ",", first, last > first ? fmt::format("-{}", last) : "");
    first = last;
  }
  return list;
}

/// Pages of the stack that the ticks will use are fetched now. Locked memory is there anyway; this is for the other
/// case.
void fetchStack() noexcept {
  constexpr std::size_t kUsedByTicks = 256 * 1024;
  constexpr std::size_t kPage = 4096;
  std::array<volatile char, kUsedByTicks> stack;
  for (std::size_t byte = 0; byte < stack.size(); byte += kPage) {
    stack[byte] = 0;
  }
}

void addAdvice(std::string& advice, std::string_view lack, int error, std::string_view remedy) {
  advice += fmt::format("{}{} ({}){}{}", advice.empty() ? "" : "; ", lack, std::strerror(error),
                        remedy.empty() ? "" : ": ", remedy);
}

}  // namespace

void requireUsableCpu(int cpu) {
  if (cpu == kAnyCpu) {
    return;
  }
  const CpuSet usable = usableCpus();
  if (cpu < 0 || static_cast<std::size_t>(cpu) >= usable.size() || !usable[static_cast<std::size_t>(cpu)]) {
    throw InvalidParameter("cpu", fmt::format("{}", cpu),
                           fmt::format("{} (any) or a CPU that this process may use: {}", kAnyCpu, text(usable)));
  }
}

RealTime requestRealTime(const LoopParameters& loop, bool lock_memory) {
  RealTime granted;
  if (loop.cpu != kAnyCpu) {
    CpuSet only;
    only.set(static_cast<std::size_t>(loop.cpu));
    if (const int refused = runThisThreadOn(only); refused == 0) {
      granted.cpu = loop.cpu;
    } else {
      addAdvice(granted.advice, fmt::format("not pinned to CPU {}", loop.cpu), refused, "");
    }
  }
  if (!loop.real_time) {
    return granted;
  }
  fetchStack();
  if (const int refused = setPriorityOfThisThread(kRealTimePriority); refused == 0) {
    granted.scheduler = schedulerName(true);
  } else {
    addAdvice(granted.advice, "no real-time priority", refused, kPriorityRemedy);
    wakeThisThreadPromptly();
  }
  if (!lock_memory) {
    return granted;
  }
  const int refused = lockMemory();
  granted.memory_locked = refused == 0;
  if (refused != 0) {
    addAdvice(granted.advice, "memory not locked", refused, kMemoryRemedy);
  }
  return granted;
}

HelperSchedule helpersSchedule() noexcept {
  HelperSchedule schedule;
  schedule.priority = std::max(0, priorityOfThisThread() - 1);
  if (const CpuSet own = cpusOfThisThread(); own.count() == 1) {
    while (!own[static_cast<std::size_t>(++schedule.avoided_cpu)]) {
    }
  }
  return schedule;
}

}  // namespace haptolith

#include "haptolith/haptics/real_time.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "haptolith/core/error.h"
#include "haptolith/core/process/start_thread.h"

namespace haptolith {

namespace {

/// CPUs that a thread of this process may be pinned to. Its default set is not complete: isolcpus excludes the
/// isolated ones until a thread requests them. So a thread requests all, and checks the result.
cpu_set_t usableCpus() {
  cpu_set_t usable;
  CPU_ZERO(&usable);
  startThread("finding out which CPUs there are", [&usable] {
    cpu_set_t all;
    std::memset(&all, 0xff, sizeof all);
    sched_setaffinity(0, sizeof all, &all);
    sched_getaffinity(0, sizeof usable, &usable);
  }).join();
  return usable;
}

/// For example "0-3,6".
std::string text(const cpu_set_t& cpus) {
  std::string list;
  for (int first = 0; first < CPU_SETSIZE; ++first) {
    if (!CPU_ISSET(first, &cpus)) {
      continue;
    }
    int last = first;
    while (last + 1 < CPU_SETSIZE && CPU_ISSET(last + 1, &cpus)) {
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
  const cpu_set_t usable = usableCpus();
  if (cpu < 0 || cpu >= CPU_SETSIZE || !CPU_ISSET(cpu, &usable)) {
    throw InvalidParameter("cpu", fmt::format("{}", cpu),
                           fmt::format("{} (any) or a CPU that this process may use: {}", kAnyCpu, text(usable)));
  }
}

RealTime requestRealTime(const LoopParameters& loop, bool lock_memory) {
  RealTime granted;
  if (loop.cpu != kAnyCpu) {
    cpu_set_t only;
    CPU_ZERO(&only);
    CPU_SET(static_cast<std::size_t>(loop.cpu), &only);
    if (const int refused = pthread_setaffinity_np(pthread_self(), sizeof only, &only); refused == 0) {
      granted.cpu = loop.cpu;
    } else {
      addAdvice(granted.advice, fmt::format("not pinned to CPU {}", loop.cpu), refused, "");
    }
  }
  if (!loop.real_time) {
    return granted;
  }
  fetchStack();
  sched_param parameters{};
  parameters.sched_priority = kRealTimePriority;
  if (const int refused = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters); refused == 0) {
    granted.scheduler = "SCHED_FIFO";
  } else {
    addAdvice(granted.advice, "no real-time priority", refused, kPriorityRemedy);
    // Else the kernel may wake the thread up to 50 us late, to wake several at once. Real-time threads it never delays.
    prctl(PR_SET_TIMERSLACK, 1);
  }
  if (!lock_memory) {
    return granted;
  }
  granted.memory_locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (!granted.memory_locked) {
    addAdvice(granted.advice, "memory not locked", errno, kMemoryRemedy);
  }
  return granted;
}

HelperSchedule helpersSchedule() noexcept {
  HelperSchedule schedule;
  int policy = SCHED_OTHER;
  sched_param parameters{};
  if (pthread_getschedparam(pthread_self(), &policy, &parameters) == 0 && policy == SCHED_FIFO) {
    schedule.priority = parameters.sched_priority - 1;
  }
  cpu_set_t own;
  if (pthread_getaffinity_np(pthread_self(), sizeof own, &own) == 0 && CPU_COUNT(&own) == 1) {
    for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
      schedule.avoided_cpu = CPU_ISSET(cpu, &own) ? cpu : schedule.avoided_cpu;
    }
  }
  return schedule;
}

}  // namespace haptolith

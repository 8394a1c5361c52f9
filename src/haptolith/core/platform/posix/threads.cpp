#include "haptolith/core/platform/threads.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstring>

#include "haptolith/core/platform/start_thread.h"

namespace haptolith {

namespace {

static_assert(CpuSet().size() >= CPU_SETSIZE);

CpuSet cpuSetOf(const cpu_set_t& cpus) noexcept {
  CpuSet set;
  for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    set[cpu] = CPU_ISSET(cpu, &cpus);
  }
  return set;
}

}  // namespace

// The default set of a thread is not complete: isolcpus excludes the isolated ones until a thread requests them. So a
// thread requests all, and checks the result.
CpuSet usableCpus() {
  CpuSet usable;
  startThread("finding out which CPUs there are", [&usable] {
    cpu_set_t all;
    std::memset(&all, 0xff, sizeof all);
    sched_setaffinity(0, sizeof all, &all);
    usable = cpusOfThisThread();
  }).join();
  return usable;
}

CpuSet cpusOfThisThread() noexcept {
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  (void)pthread_getaffinity_np(pthread_self(), sizeof cpus, &cpus);
  return cpuSetOf(cpus);
}

int runThisThreadOn(const CpuSet& cpus) noexcept {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (cpus[cpu]) {
      CPU_SET(cpu, &set);
    }
  }
  return pthread_setaffinity_np(pthread_self(), sizeof set, &set);
}

int priorityOfThisThread() noexcept {
  int policy = SCHED_OTHER;
  sched_param parameters{};
  const bool known = pthread_getschedparam(pthread_self(), &policy, &parameters) == 0;
  return known && policy == SCHED_FIFO ? parameters.sched_priority : 0;
}

int setPriorityOfThisThread(int priority) noexcept {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), priority > 0 ? SCHED_FIFO : SCHED_OTHER, &parameters);
}

std::string_view schedulerName(bool real_time) noexcept {
  return real_time ? "SCHED_FIFO" : "SCHED_OTHER";
}

// The kernel may wake a thread up to 50 us late, to wake several at once. Real-time threads it never delays.
void wakeThisThreadPromptly() noexcept {
  prctl(PR_SET_TIMERSLACK, 1);
}

int lockMemory() noexcept {
  return mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
}

}  // namespace haptolith

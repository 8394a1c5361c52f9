#include "haptolith/haptics/real_time.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

namespace haptolith {

namespace {
/// Above ordinary real-time work, below the kernel's own threads.
constexpr int kPriority = 80;
}  // namespace

RealTime requestRealTime() {
  RealTime granted;
  sched_param parameters{};
  parameters.sched_priority = kPriority;
  const int refused = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (refused == 0) {
    granted.scheduler = "SCHED_FIFO";
  } else {
    granted.advice = fmt::format("no real-time priority ({}); add 'USER - rtprio {}' to /etc/security/limits.conf",
                                 std::strerror(refused), kPriority);
  }
  granted.memory_locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (!granted.memory_locked) {
    granted.advice += fmt::format("{}memory not locked ({}); add 'USER - memlock unlimited' there",
                                  granted.advice.empty() ? "" : "; ", std::strerror(errno));
  }
  return granted;
}

}  // namespace haptolith

#include "haptolith/haptics/real_time.h"

#include <gmock/gmock.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <string>
#include <thread>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

std::vector<int> affinity() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  std::vector<int> cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(cpu, &set)) {
      cpus.push_back(cpu);
    }
  }
  return cpus;
}

/// Effect of requestRealTime() on a thread, queried by that thread.
struct Prepared {
  RealTime granted;
  std::vector<int> cpus;
  int scheduler = -1, priority = -1, timer_slack_ns = -1;
};

Prepared prepare(const LoopParameters& loop) {
  Prepared seen;
  std::thread([&] {
    seen.granted = requestRealTime(loop);
    seen.cpus = affinity();
    seen.scheduler = sched_getscheduler(0);
    sched_param parameters{};
    sched_getparam(0, &parameters);
    seen.priority = parameters.sched_priority;
    seen.timer_slack_ns = prctl(PR_GET_TIMERSLACK);
  }).join();
  munlockall();
  return seen;
}

TEST(RealTime, PinsTheThreadToTheCpuThatIsNamedAndNoOtherThread) {
  const std::vector<int> before = affinity();
  for (const int cpu : {before.front(), before.back()}) {
    for (const bool real_time : {false, true}) {
      const Prepared thread = prepare({.real_time = real_time, .cpu = cpu});
      EXPECT_EQ(thread.cpus, std::vector<int>{cpu});
      EXPECT_EQ(thread.granted.cpu, cpu);
    }
  }
  EXPECT_EQ(affinity(), before);
  EXPECT_EQ(prepare({}).cpus, before);
  EXPECT_EQ(prepare({}).granted.cpu, kAnyCpu);
}

TEST(RealTime, SaysWhatTheThreadReallyGot) {
  const Prepared thread = prepare({});
  const bool granted = thread.granted.scheduler == "SCHED_FIFO";
  EXPECT_EQ(thread.scheduler, granted ? SCHED_FIFO : SCHED_OTHER);
  EXPECT_EQ(thread.priority, granted ? kRealTimePriority : 0);
  EXPECT_EQ(thread.granted.advice.find(kPriorityRemedy) == std::string::npos, granted) << thread.granted.advice;
  EXPECT_EQ(thread.granted.advice.find(kMemoryRemedy) == std::string::npos, thread.granted.memory_locked);
  if (!granted) {
    EXPECT_EQ(thread.timer_slack_ns, 1);
  }
}

TEST(RealTime, AsksForNothingWhenTheLoopIsNotInRealTime) {
  const Prepared thread = prepare({.real_time = false});
  EXPECT_EQ(thread.scheduler, SCHED_OTHER);
  EXPECT_FALSE(thread.granted.memory_locked);
  EXPECT_EQ(thread.granted.advice, "");
}

TEST(RealTime, ACpuThatCannotBeHadIsTold) {
  const Prepared thread = prepare({.real_time = false, .cpu = CPU_SETSIZE - 1});
  EXPECT_EQ(thread.granted.cpu, kAnyCpu);
  EXPECT_THAT(thread.granted.advice, HasSubstr("not pinned to CPU 1023"));
}

std::string refusal(int cpu) {
  try {
    requireUsableCpu(cpu);
    return "";
  } catch (const InvalidParameter& error) {
    return error.what();
  }
}

TEST(RequireUsableCpu, TakesWhatTheProcessMayUseAndNoOther) {
  const std::vector<int> usable = affinity();
  EXPECT_EQ(refusal(kAnyCpu), "");
  EXPECT_EQ(refusal(usable.front()), "");
  EXPECT_EQ(refusal(usable.back()), "");
  for (const int cpu : {-2, CPU_SETSIZE - 1, CPU_SETSIZE, 1 << 30}) {
    EXPECT_THAT(refusal(cpu), HasSubstr("cpu = " + std::to_string(cpu) + " is not valid")) << cpu;
    EXPECT_THAT(refusal(cpu), HasSubstr("this process may use: ")) << cpu;
  }
}

TEST(RequireUsableCpu, TakesACpuThatMustBeAskedFor) {
  // As isolcpus and taskset do: the thread does not run there of itself, but may.
  const std::vector<int> usable = affinity();
  if (usable.size() < 2) {
    GTEST_SKIP() << "there is only one CPU";
  }
  std::thread([&] {
    (void)requestRealTime({.real_time = false, .cpu = usable.front()});
    EXPECT_EQ(refusal(usable.back()), "");
    EXPECT_EQ(affinity(), std::vector<int>{usable.front()}) << "asking pins nobody";
    EXPECT_EQ(requestRealTime({.real_time = false, .cpu = usable.back()}).cpu, usable.back());
  }).join();
}

}  // namespace
}  // namespace haptolith

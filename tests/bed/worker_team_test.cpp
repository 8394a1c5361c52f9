#include "haptolith/core/process/worker_team.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

namespace haptolith {
namespace {

struct Ledger {
  std::vector<int> calls;  // one entry per part: plain integers, so that tsan sees a part that runs twice at once
  std::vector<int> seen_parts;

  static void note(void* context, int part, int parts) noexcept {
    auto* ledger = static_cast<Ledger*>(context);
    const auto p = static_cast<std::size_t>(part);
    ++ledger->calls[p];
    ledger->seen_parts[p] = parts;
  }
};

void runRounds(int threads, int parts, int rounds, std::chrono::microseconds pause) {
  WorkerTeam team(threads);
  ASSERT_EQ(team.size(), threads);
  const auto n = static_cast<std::size_t>(parts);
  Ledger ledger{std::vector<int>(n), std::vector<int>(n)};
  for (int round = 1; round <= rounds; ++round) {
    team.run(&Ledger::note, &ledger, parts);
    ASSERT_EQ(ledger.calls, std::vector<int>(n, round));  // all done on return
    if (pause.count() > 0) {
      std::this_thread::sleep_for(pause);  // long enough for the workers to fall asleep
    }
  }
  EXPECT_EQ(ledger.seen_parts, std::vector<int>(n, parts));
}

TEST(WorkerTeam, RunsEveryPartOnceInEveryRound) {
  for (const int threads : {1, 2, 3, 5}) {
    for (const int parts : {1, 2, 7, 64}) {
      SCOPED_TRACE(testing::Message() << threads << " threads, " << parts << " parts");
      runRounds(threads, parts, 1000, std::chrono::microseconds(0));
    }
  }
}

TEST(WorkerTeam, WakesWorkersThatHaveFallenAsleep) {
  runRounds(3, 12, 100, std::chrono::microseconds(300));
}

TEST(WorkerTeam, DoesWithoutAThreadThatDoesNotCome) {
  // The helper stays in the first part that it takes until all others are done: the caller has to take the rest.
  struct Stuck {
    std::atomic<int> done{0};
    std::thread::id caller = std::this_thread::get_id();
    static void work(void* context, int /*part*/, int parts) noexcept {
      auto* stuck = static_cast<Stuck*>(context);
      if (std::this_thread::get_id() != stuck->caller) {
        while (stuck->done < parts - 1) {
          std::this_thread::yield();
        }
      }
      ++stuck->done;
    }
  } stuck;
  WorkerTeam team(2);
  for (int round = 1; round <= 20; ++round) {
    stuck.done = 0;
    team.run(&Stuck::work, &stuck, 8);
    EXPECT_EQ(stuck.done, 8);
  }
}

TEST(WorkerTeam, IsNotHeldUpForLongByAHelperWhoseCoreIsTakenAway) {
  // The helper sleeps 1 ms in each of its parts, the caller works for 1 us in each of its own. A helper that is asked
  // in each round takes nearly all of the time; on a loaded machine both take longer.
  using Clock = std::chrono::steady_clock;
  struct Taken {
    std::atomic<std::int64_t> slept_ns{0};
    std::thread::id caller = std::this_thread::get_id();
    static void work(void* context, int /*part*/, int /*parts*/) noexcept {
      auto* taken = static_cast<Taken*>(context);
      const auto start = Clock::now();
      if (std::this_thread::get_id() != taken->caller) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        taken->slept_ns += std::chrono::nanoseconds(Clock::now() - start).count();
        return;
      }
      while (Clock::now() - start < std::chrono::microseconds(1)) {
      }
    }
  } taken;
  WorkerTeam team(2);
  const auto start = Clock::now();
  for (int round = 0; round < 20000; ++round) {
    team.run(&Taken::work, &taken, 64);
  }
  const std::int64_t all_ns = std::chrono::nanoseconds(Clock::now() - start).count();
  EXPECT_GT(taken.slept_ns, 0) << "it is asked again";
  EXPECT_LT(taken.slept_ns, all_ns / 2) << "1.3 s of work alone, 0.3 s of waiting for 300 parts";
}

TEST(WorkerTeam, WorksAsEverWhenWorkWasExpected) {
  WorkerTeam team(3);
  constexpr int kParts = 12;
  Ledger ledger{std::vector<int>(kParts), std::vector<int>(kParts)};
  for (int round = 1; round <= 200; ++round) {
    team.expect(round % 2 == 0 ? 0 : 300'000);  // over when it comes, or not
    std::this_thread::sleep_for(std::chrono::microseconds(100));
    team.run(&Ledger::note, &ledger, kParts);
    ASSERT_EQ(ledger.calls, std::vector<int>(kParts, round));
  }
}

TEST(WorkerTeam, AFewThreadsThatExpectWorkEndAtOnce) {
  const auto start = std::chrono::steady_clock::now();
  {
    WorkerTeam team(3);
    team.expect(60'000'000'000);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
}

TEST(WorkerTeam, HasThePriorityThatItIsGiven) {
  struct Seen {
    std::atomic<int> helper{-1};
    std::thread::id caller = std::this_thread::get_id();
    static void work(void* context, int /*part*/, int /*parts*/) noexcept {
      auto* seen = static_cast<Seen*>(context);
      if (std::this_thread::get_id() != seen->caller) {
        int policy = SCHED_OTHER;
        sched_param parameters{};
        pthread_getschedparam(pthread_self(), &policy, &parameters);
        seen->helper = policy == SCHED_FIFO ? parameters.sched_priority : 0;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  } seen;
  const auto priority_of_helper = [&](WorkerTeam& team) {
    seen.helper = -1;
    for (int round = 0; round < 1000 && seen.helper < 0; ++round) {
      team.run(&Seen::work, &seen, 4);
    }
    return seen.helper.load();
  };
  WorkerTeam team(2);
  EXPECT_EQ(priority_of_helper(team), 0);
  sched_param real_time{};
  real_time.sched_priority = 1;
  if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &real_time) != 0) {
    GTEST_SKIP() << "this user may have no real-time priority";
  }
  real_time.sched_priority = 0;
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &real_time);
  team.schedule({.priority = 1});
  EXPECT_EQ(priority_of_helper(team), 1);
  team.schedule({});
  EXPECT_EQ(priority_of_helper(team), 0);
}

TEST(WorkerTeam, KeepsOffTheCpuOfWhomItHelps) {
  cpu_set_t usable;
  CPU_ZERO(&usable);
  ASSERT_EQ(pthread_getaffinity_np(pthread_self(), sizeof usable, &usable), 0);
  if (CPU_COUNT(&usable) < 2) {
    GTEST_SKIP() << "on one CPU there is no other";
  }
  const int avoided = CPU_ISSET(0, &usable) ? 0 : 1;
  struct Seen {
    std::atomic<int> helped{0};
    int avoided;
    std::thread::id caller = std::this_thread::get_id();
    static void work(void* context, int /*part*/, int /*parts*/) noexcept {
      auto* seen = static_cast<Seen*>(context);
      if (std::this_thread::get_id() != seen->caller) {
        cpu_set_t cpus;
        CPU_ZERO(&cpus);
        pthread_getaffinity_np(pthread_self(), sizeof cpus, &cpus);
        seen->helped = CPU_ISSET(static_cast<std::size_t>(seen->avoided), &cpus) ? 1 : 2;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  } seen{.avoided = avoided};
  const auto may_run_there = [&](WorkerTeam& team) {
    seen.helped = 0;
    for (int round = 0; round < 1000 && seen.helped == 0; ++round) {
      team.run(&Seen::work, &seen, 4);
    }
    return seen.helped == 1;
  };
  WorkerTeam team(2);
  team.schedule({.avoided_cpu = avoided});
  EXPECT_FALSE(may_run_there(team));
  team.schedule({});
  EXPECT_EQ(may_run_there(team), CPU_ISSET(static_cast<std::size_t>(avoided), &usable) != 0);
}

TEST(WorkerTeam, EndsWithoutEverHavingWorked) {
  for (int i = 0; i < 20; ++i) {
    const WorkerTeam team(4);
    EXPECT_EQ(team.size(), 4);
  }
}

TEST(WorkerTeam, WaitsForASlowPart) {
  // The caller finishes first and has to sleep until the others are done.
  struct Slow {
    int done[3] = {};
    static void work(void* context, int part, int) noexcept {
      if (part > 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2 * part));
      }
      static_cast<Slow*>(context)->done[part] += 1;
    }
  } slow;
  WorkerTeam team(3);
  for (int round = 1; round <= 10; ++round) {
    team.run(&Slow::work, &slow, 3);
    EXPECT_EQ(slow.done[0], round);
    EXPECT_EQ(slow.done[1], round);
    EXPECT_EQ(slow.done[2], round);
  }
}

}  // namespace
}  // namespace haptolith

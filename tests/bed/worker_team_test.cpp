#include "haptolith/bed/worker_team.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
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
  // All parts of one loop wait for each other's thread but one: whoever is free has to take the rest.
  struct Stuck {
    std::atomic<int> done{0};
    static void work(void* context, int part, int parts) noexcept {
      auto* stuck = static_cast<Stuck*>(context);
      if (part == parts / 2) {  // the first that the second thread begins with
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

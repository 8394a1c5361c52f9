#include "haptolith/bed/worker_team.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

namespace haptolith {
namespace {

struct Ledger {
  std::vector<int> calls;  // one entry per part: plain integers, so that tsan sees a part that runs twice at once
  std::vector<int> seen_parts;
  std::thread::id caller;
  bool first_part_on_caller = true;

  static void note(void* context, int part, int parts) noexcept {
    auto* ledger = static_cast<Ledger*>(context);
    const auto p = static_cast<std::size_t>(part);
    ++ledger->calls[p];
    ledger->seen_parts[p] = parts;
    if (part == 0) {
      ledger->first_part_on_caller = ledger->first_part_on_caller && std::this_thread::get_id() == ledger->caller;
    }
  }
};

void runRounds(int threads, int rounds, std::chrono::microseconds pause) {
  WorkerTeam team(threads);
  ASSERT_EQ(team.size(), threads);
  Ledger ledger{std::vector<int>(static_cast<std::size_t>(threads)),
                std::vector<int>(static_cast<std::size_t>(threads)), std::this_thread::get_id()};
  for (int round = 1; round <= rounds; ++round) {
    team.run(&Ledger::note, &ledger);
    ASSERT_EQ(ledger.calls, std::vector<int>(static_cast<std::size_t>(threads), round));  // all done on return
    if (pause.count() > 0) {
      std::this_thread::sleep_for(pause);  // long enough for the workers to fall asleep
    }
  }
  EXPECT_EQ(ledger.seen_parts, std::vector<int>(static_cast<std::size_t>(threads), threads));
  EXPECT_TRUE(ledger.first_part_on_caller);
}

TEST(WorkerTeam, RunsEveryPartOnceInEveryRound) {
  for (const int threads : {1, 2, 3, 5}) {
    SCOPED_TRACE(threads);
    runRounds(threads, 2000, std::chrono::microseconds(0));
  }
}

TEST(WorkerTeam, WakesWorkersThatHaveFallenAsleep) {
  runRounds(3, 100, std::chrono::microseconds(300));
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
    team.run(&Slow::work, &slow);
    EXPECT_EQ(slow.done[0], round);
    EXPECT_EQ(slow.done[1], round);
    EXPECT_EQ(slow.done[2], round);
  }
}

}  // namespace
}  // namespace haptolith

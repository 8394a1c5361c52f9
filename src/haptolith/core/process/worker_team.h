#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace haptolith {

/// Scheduling of the threads that help another. Aligned so that every compiler stores it without a lock.
struct alignas(8) HelperSchedule {
  int priority = 0;      ///< real-time priority; 0: none
  int avoided_cpu = -1;  ///< CPU that they keep off, if there is another; -1: none

  [[nodiscard]] bool operator==(const HelperSchedule&) const = default;
};

/// A few threads that share out the parts of a loop, and sleep between the loops. run() does not allocate, lock or
/// throw.
///
/// Each thread first works through its own range, the same one in every loop, so that its cache holds the data it
/// needs; then it takes parts that other threads have not started. A preempted thread therefore delays the loop by one
/// part at most. A thread that has waited for another longer than it has worked itself continues alone for a while.
class WorkerTeam {
 public:
  /// `threads` counts the caller, so 1 makes no thread at all.
  explicit WorkerTeam(int threads);
  ~WorkerTeam();
  WorkerTeam(const WorkerTeam&) = delete;
  WorkerTeam& operator=(const WorkerTeam&) = delete;

  [[nodiscard]] int size() const noexcept { return static_cast<int>(ranges_.size()); }

  /// Calls `work(context, part, parts)` once for every part in 0..parts-1, on whichever thread, and returns when all
  /// are done. May be called in the tick. @param parts  at most kMostParts.
  using Work = void (*)(void* context, int part, int parts) noexcept;
  void run(Work work, void* context, int parts) noexcept;

  static constexpr int kMostParts = 0xFFFF;

  /// Announces work: wakes the threads, which then poll for it for this time. Returns immediately; may be called in the
  /// tick's thread, between ticks.
  void expect(std::int64_t within_ns) noexcept;

  /// From the next loop on the other threads are scheduled so. The scheduler leaves a thread without priority waiting
  /// on a processor that one with priority keeps, though another processor is free; and one of lower priority on the
  /// processor that the caller is pinned to. May be called in the tick.
  void schedule(const HelperSchedule& schedule) noexcept { schedule_.store(schedule, std::memory_order_relaxed); }

 private:
  /// Parts that one thread begins with: number of the loop (32 bits), end (16), next (16), in one so that no thread
  /// takes a part of a loop that is over.
  struct alignas(64) Range {
    std::atomic<std::uint64_t> ticket{0};
  };

  void serve(std::size_t own) noexcept;
  void workOn(std::uint32_t round, std::size_t own) noexcept;
  [[nodiscard]] bool worksAlone() const noexcept;

  std::vector<Range> ranges_;  // one for each thread
  std::vector<std::thread> threads_;
  Work work_ = nullptr;
  void* context_ = nullptr;
  int parts_ = 0;
  std::int64_t alone_until_ns_ = 0;  // 0: in company
  alignas(64) std::atomic<std::uint32_t> round_{0};
  std::atomic<std::int64_t> expected_until_ns_{0};
  std::atomic<HelperSchedule> schedule_{HelperSchedule{}};
  static_assert(std::atomic<HelperSchedule>::is_always_lock_free);
  alignas(64) std::atomic<int> unfinished_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace haptolith

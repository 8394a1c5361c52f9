#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace haptolith {

/// A few threads that share out a loop, and sleep between the loops. run() does not allocate, lock or throw.
class WorkerTeam {
 public:
  /// `threads` counts the caller, so 1 makes no thread at all.
  explicit WorkerTeam(int threads);
  ~WorkerTeam();
  WorkerTeam(const WorkerTeam&) = delete;
  WorkerTeam& operator=(const WorkerTeam&) = delete;

  [[nodiscard]] int size() const noexcept { return size_; }

  /// Calls `work(context, part, parts)` once for every part in 0..parts-1, part 0 on the calling thread, and returns
  /// when all are done. May be called in the tick.
  using Work = void (*)(void* context, int part, int parts) noexcept;
  void run(Work work, void* context) noexcept;

 private:
  void serve(int part) noexcept;

  int size_;
  std::vector<std::thread> threads_;
  Work work_ = nullptr;
  void* context_ = nullptr;
  std::atomic<std::uint32_t> round_{0};
  std::atomic<int> unfinished_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace haptolith

#include "haptolith/bed/worker_team.h"

namespace haptolith {

namespace {

/// Looks this often before going to sleep: about 20 us, longer than the gap between two substeps of one tick, much
/// shorter than a tick, so that a worker never burns a core that somebody else could use.
constexpr int kLooksBeforeSleep = 400;

inline void relax() noexcept {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

WorkerTeam::WorkerTeam(int threads) : size_(threads) {
  for (int part = 1; part < size_; ++part) {
    threads_.emplace_back([this, part] { serve(part); });
  }
}

WorkerTeam::~WorkerTeam() {
  stop_ = true;
  round_.fetch_add(1);
  round_.notify_all();
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

void WorkerTeam::run(Work work, void* context) noexcept {
  if (size_ > 1) {
    work_ = work;
    context_ = context;
    unfinished_.store(size_ - 1, std::memory_order_relaxed);
    round_.fetch_add(1, std::memory_order_release);
    round_.notify_all();
  }
  work(context, 0, size_);
  for (int looks = 0;; ++looks) {
    const int unfinished = unfinished_.load(std::memory_order_acquire);
    if (unfinished == 0) {
      return;
    }
    if (looks < kLooksBeforeSleep) {
      relax();
    } else {
      unfinished_.wait(unfinished, std::memory_order_acquire);
    }
  }
}

void WorkerTeam::serve(int part) noexcept {
  std::uint32_t seen = 0;
  for (;;) {
    for (int looks = 0; round_.load(std::memory_order_acquire) == seen; ++looks) {
      if (looks < kLooksBeforeSleep) {
        relax();
      } else {
        round_.wait(seen, std::memory_order_acquire);
      }
    }
    ++seen;
    if (stop_) {
      return;
    }
    work_(context_, part, size_);
    if (unfinished_.fetch_sub(1, std::memory_order_acq_rel) == 1) {
      unfinished_.notify_one();
    }
  }
}

}  // namespace haptolith

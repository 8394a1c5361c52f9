#include "haptolith/core/process/worker_team.h"

#include <algorithm>

#include "haptolith/core/assert.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/core/platform/sleep_while.h"
#include "haptolith/core/platform/threads.h"

namespace haptolith {

namespace {

/// Time of polling before going to sleep: longer than the gap between two substeps of one tick, because a wake-up takes
/// about 100 us; much shorter than a tick, so that no core is kept from other programs.
constexpr std::int64_t kLooking_ns = 50'000;
constexpr int kLooksBetweenClocks = 64;

/// Time worked alone per nanosecond lost in waiting: at most a fifth of the time is ever lost to a helper
/// whose core is taken away again and again, as on a machine that others share, where loops in company once took fifty
/// times as long as alone; and a single mishap of 1 ms costs no more than four ticks of help.
constexpr std::int64_t kAloneForEachLost = 4;

/// Waits until `value` is no longer `old`, looking until `at_least_ns` at any rate.
template <class T>
void waitWhile(const std::atomic<T>& value, T old, std::int64_t at_least_ns) noexcept {
  std::int64_t until_ns = 0;
  for (int looks = 1; value.load(std::memory_order_acquire) == old; ++looks) {
    relax();
    if (looks % kLooksBetweenClocks == 0) {
      const std::int64_t now_ns = monotonicNs();
      until_ns = until_ns == 0 ? std::max(now_ns + kLooking_ns, at_least_ns) : until_ns;
      if (now_ns >= until_ns) {
        sleepWhile(value, old);
      }
    }
  }
}

/// Schedules the calling thread so, as far as the system lets it. @param usual  the CPUs that it ran on when it began.
void scheduleThisThread(const HelperSchedule& schedule, const CpuSet& usual) noexcept {
  (void)setPriorityOfThisThread(schedule.priority);
  CpuSet cpus = usual;
  if (schedule.avoided_cpu >= 0 && cpus.count() > 1) {
    cpus.reset(static_cast<std::size_t>(schedule.avoided_cpu));
  }
  (void)runThisThreadOn(cpus);
}

constexpr int kRoundShift = 32;
constexpr int kEndShift = 16;
constexpr std::uint64_t kPartMask = 0xFFFF;

}  // namespace

WorkerTeam::WorkerTeam(int threads) : ranges_(static_cast<std::size_t>(threads)) {
  for (std::size_t own = 1; own < ranges_.size(); ++own) {
    threads_.emplace_back([this, own] { serve(own); });
  }
}

WorkerTeam::~WorkerTeam() {
  stop_ = true;
  round_.fetch_add(1);
  wakeAll(round_);
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

bool WorkerTeam::worksAlone() const noexcept {
  return alone_until_ns_ != 0 && monotonicNs() < alone_until_ns_;
}

void WorkerTeam::expect(std::int64_t within_ns) noexcept {
  HAPTO_ASSERT(within_ns >= 0);
  if (ranges_.size() == 1 || worksAlone()) {
    return;
  }
  expected_until_ns_.store(monotonicNs() + within_ns, std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);  // a round without parts
  wakeAll(round_);
}

void WorkerTeam::run(Work work, void* context, int parts) noexcept {
  HAPTO_ASSERT(work != nullptr);
  HAPTO_ASSERT(parts >= 1 && parts <= static_cast<int>(kPartMask));
  if (ranges_.size() == 1 || parts == 1 || worksAlone()) {
    for (int part = 0; part < parts; ++part) {
      work(context, part, parts);
    }
    return;
  }
  work_ = work;
  context_ = context;
  parts_ = parts;
  unfinished_.store(parts, std::memory_order_relaxed);
  const std::uint32_t round = round_.load(std::memory_order_relaxed) + 1;
  const auto share = [&](std::size_t thread) { return static_cast<std::uint64_t>(parts) * thread / ranges_.size(); };
  for (std::size_t thread = 0; thread < ranges_.size(); ++thread) {
    ranges_[thread].ticket.store(std::uint64_t{round} << kRoundShift | share(thread + 1) << kEndShift | share(thread),
                                 std::memory_order_release);
  }
  round_.store(round, std::memory_order_release);
  const std::int64_t begin_ns = monotonicNs();
  wakeAll(round_);
  workOn(round, 0);
  alone_until_ns_ = 0;
  if (unfinished_.load(std::memory_order_acquire) == 0) {
    return;
  }
  const std::int64_t finished_ns = monotonicNs();
  for (int left = unfinished_.load(std::memory_order_acquire); left > 0;
       left = unfinished_.load(std::memory_order_acquire)) {
    waitWhile(unfinished_, left, 0);
  }
  const std::int64_t now_ns = monotonicNs();
  const std::int64_t lost_ns = now_ns - finished_ns;
  if (lost_ns > kLooking_ns && lost_ns > finished_ns - begin_ns) {  // more than help could have saved
    alone_until_ns_ = now_ns + kAloneForEachLost * lost_ns;
  }
}

void WorkerTeam::workOn(std::uint32_t round, std::size_t own) noexcept {
  HAPTO_ASSERT(own < ranges_.size());
  for (std::size_t turn = 0; turn < ranges_.size(); ++turn) {
    std::atomic<std::uint64_t>& ticket = ranges_[(own + turn) % ranges_.size()].ticket;
    std::uint64_t seen = ticket.load(std::memory_order_acquire);
    while (seen >> kRoundShift == round && (seen & kPartMask) < (seen >> kEndShift & kPartMask)) {
      if (ticket.compare_exchange_weak(seen, seen + 1, std::memory_order_acq_rel, std::memory_order_acquire)) {
        work_(context_, static_cast<int>(seen & kPartMask), parts_);
        if (unfinished_.fetch_sub(1, std::memory_order_acq_rel) == 1) {
          wakeAll(unfinished_);  // the caller of run()
        }
        seen = ticket.load(std::memory_order_acquire);
      }
    }
  }
}

void WorkerTeam::serve(std::size_t own) noexcept {
  std::uint32_t seen = 0;
  HelperSchedule schedule;
  const CpuSet usual = cpusOfThisThread();
  for (;;) {
    waitWhile(round_, seen, expected_until_ns_.load(std::memory_order_relaxed));
    seen = round_.load(std::memory_order_acquire);
    if (stop_) {
      return;
    }
    if (const HelperSchedule wanted = schedule_.load(std::memory_order_relaxed); wanted != schedule) {
      scheduleThisThread(wanted, usual);
      schedule = wanted;
    }
    workOn(seen, own);
  }
}

}  // namespace haptolith

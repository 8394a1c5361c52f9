#include "haptolith/session/record_taker.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "haptolith/core/platform/start_thread.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;

/// 30 s at 1 kHz, about 13 MB.
constexpr std::size_t kMostKept = 30'000;

/// Polling period while there is a listener.
constexpr std::chrono::microseconds kSoon = 500us;

}  // namespace

RecordTaker::RecordTaker(HapticLoop& loop, SessionRecording& recording, Keep keep, bool real_time, Listener listener)
    : loop_(loop),
      recording_(recording),
      keeps_(keep == Keep::kForTake),
      real_time_(real_time),
      listener_(std::move(listener)) {
  thread_ = startThread("taking what is recorded", [this] {
    while (!ends_) {
      {
        const std::lock_guard lock(mutex_);
        takeNow();
      }
      std::this_thread::sleep_for(listener_ ? kSoon : real_time_ ? 10ms : 1ms);
    }
  });
}

RecordTaker::~RecordTaker() {
  ends_ = true;
  thread_.join();
}

void RecordTaker::takeNow() {
  if (keeps_ && !real_time_ && kept_.size() >= kMostKept) {
    return;
  }
  fresh_.clear();
  loop_.takeRecords(fresh_);
  recording_.add(fresh_);
  std::erase_if(fresh_, [](const TickRecord& record) { return record.tool != 0; });
  if (listener_) {
    listener_(fresh_);
  }
  if (keeps_) {
    const std::size_t room = real_time_ ? kMostKept - std::min(kept_.size(), kMostKept) : fresh_.size();
    const std::size_t count = std::min(room, fresh_.size());
    kept_.insert(kept_.end(), fresh_.begin(), fresh_.begin() + static_cast<std::ptrdiff_t>(count));
    not_kept_ += fresh_.size() - count;
  }
}

void RecordTaker::take(std::vector<TickRecord>& ticks) {
  const std::lock_guard lock(mutex_);
  const auto hand_over = [&] {
    ticks.insert(ticks.end(), kept_.begin(), kept_.end());
    kept_.clear();
  };
  hand_over();  // makes room
  takeNow();
  hand_over();
}

std::uint64_t RecordTaker::lost() const {
  const std::lock_guard lock(mutex_);
  return loop_.lostRecords() + not_kept_;
}

}  // namespace haptolith

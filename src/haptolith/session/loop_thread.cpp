#include "haptolith/session/loop_thread.h"

#include <chrono>

namespace haptolith {

LoopThread::LoopThread(HapticLoop& loop, bool paced, std::atomic<bool>& stop)
    : stop_(stop), thread_([this, &loop, paced] {
        if (paced) {
          real_time_ = requestRealTime();
        }
        real_time_known_.store(true, std::memory_order_release);
        end_ = loop.run(stop_);
        done_.store(true, std::memory_order_release);
      }) {}

LoopThread::~LoopThread() {
  if (thread_.joinable()) {  // an error on the other side: the hand is let go before anybody hears of it
    stop_ = true;
    thread_.join();
  }
}

const RealTime& LoopThread::realTime() const {
  while (!real_time_known_.load(std::memory_order_acquire)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return real_time_;
}

LoopEnd LoopThread::join() {
  if (thread_.joinable()) {
    thread_.join();
  }
  return end_;
}

}  // namespace haptolith

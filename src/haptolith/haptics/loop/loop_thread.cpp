#include "haptolith/haptics/loop/loop_thread.h"

#include <chrono>

#include "haptolith/core/platform/start_thread.h"

namespace haptolith {

LoopThread::LoopThread(HapticLoop& loop, const LoopParameters& parameters, std::atomic<bool>& stop) : stop_(stop) {
  requireUsableCpu(parameters.cpu);
  thread_ = startThread("the loop", [this, &loop, parameters] {
    real_time_ = requestRealTime(parameters);
    real_time_known_.store(true, std::memory_order_release);
    end_ = loop.run(stop_);
    done_.store(true, std::memory_order_release);
  });
}

LoopThread::~LoopThread() {
  if (thread_.joinable()) {  // an error on the other side: the force is released before the error propagates
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

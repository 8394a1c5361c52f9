#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Runs work(0) to work(count - 1) on up to `threads` threads, each piece on one; the order is open, so pieces must not
/// share anything they write. @throws what the first failing piece threw, after the running ones have ended.
void inParallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

/// Conditions for piece `index` of `count` equal pieces that run in parallel: one thread each, and a progress that
/// tells `conditions.progress`, one thread at a time, how far all of them together are.
class SharedProgress {
 public:
  SharedProgress(const LabConditions& conditions, std::size_t count);
  ~SharedProgress();
  SharedProgress(const SharedProgress&) = delete;
  SharedProgress& operator=(const SharedProgress&) = delete;

  [[nodiscard]] LabConditions conditionsOf(std::size_t index);

 private:
  struct State;
  LabConditions conditions_;
  std::unique_ptr<State> state_;
};

}  // namespace haptolith

#pragma once

#include <cstddef>
#include <memory>

#include "haptolith/lab/laboratory.h"

namespace haptolith {

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

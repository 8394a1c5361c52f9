#pragma once

#include <cstddef>
#include <memory>

#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Conditions for piece `index` of `count` equal pieces that run in parallel, one thread each. Their progress reports
/// the total of all pieces to `conditions.progress`, one thread at a time.
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

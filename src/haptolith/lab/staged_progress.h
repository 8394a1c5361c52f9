#pragma once

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>

#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Progress of a test with stages: maps 0 to 1 of a stage to its part of the total. Never decreases.
class StagedProgress {
 public:
  explicit StagedProgress(LabProgress told) : stage_(std::make_shared<Stage>()) { stage_->told = std::move(told); }

  /// Enters a stage: 0 to 1 becomes `begin` to `end` of the entire test.
  void enter(double begin, double end) {
    stage_->begin = begin;
    stage_->end = end;
  }

  /// Returns the callback for the conditions of the stages; may outlive this object. Empty without a receiver.
  [[nodiscard]] LabProgress inner() const {
    if (!stage_->told) {
      return {};
    }
    return [stage = stage_](std::string_view what, double share) {
      const double now = stage->begin + std::clamp(share, 0.0, 1.0) * (stage->end - stage->begin);
      stage->furthest = std::clamp(now, stage->furthest, 1.0);
      return stage->told(what, stage->furthest);
    };
  }

 private:
  struct Stage {
    LabProgress told;
    double begin = 0, end = 1, furthest = 0;
  };
  std::shared_ptr<Stage> stage_;
};

}  // namespace haptolith

#pragma once

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>

#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// The progress of a test that is done in stages: what a stage reports as 0 to 1 becomes its share of the whole. Never
/// goes back.
class StagedProgress {
 public:
  explicit StagedProgress(LabProgress told) : stage_(std::make_shared<Stage>()) { stage_->told = std::move(told); }

  /// From now on 0 to 1 means `begin` to `end` of the whole test.
  void enter(double begin, double end) {
    stage_->begin = begin;
    stage_->end = end;
  }

  /// For the stages' own conditions; outlives this. Empty when nobody is told.
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

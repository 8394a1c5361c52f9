#include "haptolith/trust/moving_scene.h"

#include <fmt/format.h>

#include <cmath>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

SceneFile prepared(const TrustRun& run, int threads) {
  SceneFile file = run.scene;
  file.bed.threads = threads;
  file.loop.real_time = false;
  file.loop.duration_s = 0;
  file.device = {};  // the scene's movement, whatever device it names
  for (SceneTool& tool : file.more_tools) {
    tool.device = {};
  }
  return file;
}

SettleProgress settling(const TrustProgress& progress) {
  if (!progress) {
    return {};
  }
  return [progress](double time_s, double) {
    constexpr double kUsual_s = 2;
    return progress("the soil settles", 0.5 * (1 - std::exp(-time_s / kUsual_s)));
  };
}

}  // namespace

MovingScene::MovingScene(const TrustRun& run, int threads, const TrustProgress& progress)
    : file_(prepared(run, threads)), scene_(file_.bed, toolSet(file_), settling(progress)) {
  if (run.step_factor > 1) {
    scene_.refineSteps(run.step_factor);
  }
  surface_m_ = scene_.bed().surfaceHeight();
  std::vector<ToolHandling> handlings;
  for (std::size_t tool = 0; tool < toolCount(file_); ++tool) {
    exchangeFirst(file_, tool);
    handlings.push_back(handlingOfFirst(run));
    exchangeFirst(file_, tool);
  }
  loop_ = std::make_unique<HapticLoop>(scene_, handlings, file_.loop, false);
}

bool MovingScene::tick() {
  const LoopEnd end = loop_->tick();
  if (end == LoopEnd::kRunning || end == LoopEnd::kFinished) {
    return end == LoopEnd::kRunning;
  }
  throw Failure(fmt::format("the movement ended at {:.3f} s: {}", loop_->time(), text(end)));
}

std::vector<HandState> MovingScene::nextMovements() {
  std::vector<HandState> movements;
  for (const auto& hand : hands_) {
    const DeviceInput input = hand->read();
    movements.push_back({{input.pose, input.twist}, input.gripper_open});
  }
  return movements;
}

/// A virtual hand for the tool that is the first now, and its handling.
ToolHandling MovingScene::handlingOfFirst(const TrustRun& run) {
  const double raised_m = run.usual_surface_m ? surface_m_ - *run.usual_surface_m : 0;
  file_.hand.surface_m = file_.hand.surface_m ? *file_.hand.surface_m + raised_m : surface_m_;
  HandlingParameters handling = handlingOf(file_, *file_.hand.surface_m);
  handling.mapping.offset_m += run.shift_m;
  if (file_.hand.motion == HandMotion::kPoses) {  // which are places in the scene
    handling.mapping.offset_m.z() += raised_m;
  }
  hands_.push_back(std::make_unique<VirtualHand>(file_.hand, file_.bed.tick_s));
  return {hands_.back().get(), handling};
}

}  // namespace haptolith

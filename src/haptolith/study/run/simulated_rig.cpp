#include "haptolith/study/run/simulated_rig.h"

#include <algorithm>
#include <stdexcept>

namespace haptolith {

SimulatedRig::SimulatedRig(const StudyProtocol& protocol, const ExplorationOptions& options)
    : protocol_(protocol), next_(options) {
  (void)exploringHand(protocol.scene, options);  // throws
  for (const StudyBlock& block : protocol.blocks) {
    if (!block.teleop) {
      requireReach(sceneOf(protocol, block, block.reference), options.motion);
    }
  }
}

void SimulatedRig::show(const StudyBlock& block, const Stimulus& stimulus) {
  const SceneFile scene = sceneOf(protocol_, block, stimulus);
  const auto found = std::ranges::find(shown_, scene, &Shown::scene);
  now_ = static_cast<std::size_t>(found - shown_.begin());
  if (found == shown_.end()) {
    shown_.push_back({scene, levelBed(scene)});
  }
}

void SimulatedRig::feel() {
  if (shown_.empty()) {
    throw std::logic_error("felt before anything was shown");
  }
  feels_ = true;
}

TrialSummary SimulatedRig::rest() {
  if (!feels_) {
    throw std::logic_error("rests without having felt");
  }
  feels_ = false;
  const Exploration explored = explore(shown_[now_].scene, shown_[now_].bed, next_);
  ++next_.seed;
  return explored.summary;
}

}  // namespace haptolith
